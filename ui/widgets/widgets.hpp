// widgets.hpp -- what the panel is made of: sections, rows of label and widget, buttons.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "ui/automation/widget_rects.hpp"
#include "ui/widgets/formats.hpp"
#include "ui/widgets/setting_rows.hpp"
#include "ui/widgets/theme.hpp"

namespace clarity::ui {

class Session;

// Starts a section with its title.
void section(const char* title);
// The same, and a click on the title folds it. Returns whether it is open; `open`: at first.
bool folding_section(const char* title, bool open = true);
// A label at the left with its help as tooltip; the next item fills the rest of the line.
void row_label(const char* label, const std::string& help = {});
// Label and a value that is only read. Coloured where it warns.
void row_text(const char* label, const std::string& value, const std::string& help = {}, const ImVec4& color = colors::kText);
void tooltip(const std::string& text);  // of the last item
// An entry of an open list. Returns whether it was chosen anew.
bool option(const std::string& label, bool chosen);
// A slider whose value applies while it is dragged.
bool slider(const char* id, float& value, float min, float max, const char* format, bool logarithmic = false);
// A colour of linear light, values above 1 allowed.
bool color_field(const char* id, float* rgb);
// Text in a colour, on as many lines as it needs.
void wrapped_text(const std::string& text, const ImVec4& color = colors::kText);
// The same in the dimmed colour.
void dim_text(const std::string& text);

// width: as ImGui takes it, or 0. Its place is noted under the label, up to "##".
bool button(const char* label, const std::string& help = {}, float width = 0);
bool toggle_button(const char* label, bool on, const std::string& help = {}, float width = 0);
// The widths of `count` equal buttons in what is left of the line.
float share_of_line(int count);
// Starts the next button on this line if it fits there, else on the next.
void same_line_if_fits(const char* next_label);

// The beginning of a text that fits, or its end: a path keeps its file's name.
std::string cut_to(const std::string& text, float width);
std::string cut_front_to(const std::string& text, float width);

// Does it; an Error becomes the session's message.
void attempt(Session& session, const std::function<void()>& what);

}  // namespace clarity::ui
