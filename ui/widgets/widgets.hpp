// widgets.hpp -- the building blocks of the panel: sections, rows of label and widget, buttons.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "rt_plugin.h"
#include "ui/widgets/formats.hpp"
#include "ui/widgets/rect.hpp"
#include "ui/widgets/theme.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {

// Rows drawn from the settings table and from the plugins' parameter tables.

// Draws a row of the settings table. Returns whether `settings` changed. Settings which make the host rebuild or recompile
// change when the mouse button is released, all others while the slider is dragged.
bool setting_row(const Setting& row, Settings& settings);
// The same for a parameter of a plugin.
bool parameter_row(const rt_param& param, double& value);

// The rectangles in which rows, buttons and list entries were drawn. Tests click there.

// Notes the rectangle of the last item, or the given one. It counts as visible inside the clip rectangle of the current window.
void note_rect(const std::string& label);
void note_rect(const std::string& label, const Rect& place);
// Returns nullptr if nothing with this label is visible. If it is scrolled out of sight, the next frame scrolls it into view:
// ask again then.
const Rect* drawn_rect(const std::string& label);

class Session;

// Starts a section with its title.
void section(const char* title);
// Like section(), but a click on the title folds it. Returns whether it is open. open: its state at first.
bool folding_section(const char* title, bool open = true);
// Draws a label at the left, with its help as tooltip. The next item fills the rest of the line.
void row_label(const char* label, const std::string& help = {});
// Draws a label and a read-only value. A colour marks warnings.
void row_text(const char* label, const std::string& value, const std::string& help = {}, const ImVec4& color = colors::kText);
void tooltip(const std::string& text);  // for the last item
// An entry of an open list. Returns whether the user chose it now.
bool option(const std::string& label, bool chosen);
// A slider. Its value applies while it is dragged.
bool slider(const char* id, float& value, float min, float max, const char* format, bool logarithmic = false);
// A field for a colour in linear light. Values above 1 are allowed.
bool color_field(const char* id, float* rgb);
// Draws coloured text, wrapped to as many lines as it needs.
void wrapped_text(const std::string& text, const ImVec4& color = colors::kText);
// Like wrapped_text(), in the dimmed colour.
void dim_text(const std::string& text);

// A button. width: as in ImGui, 0 for the text's width. Its rectangle is noted under the label up to "##".
bool button(const char* label, const std::string& help = {}, float width = 0);
bool toggle_button(const char* label, bool on, const std::string& help = {}, float width = 0);
// The width of each of `count` equal buttons in the rest of the line.
float share_of_line(int count);
// Puts the next button on this line if it fits, otherwise on the next line.
void same_line_if_fits(const char* next_label);

// Cut a text to the width: keeps its beginning, or its end (for a path, which ends in the file's name).
std::string cut_to(const std::string& text, float width);
std::string cut_front_to(const std::string& text, float width);

// Runs `what`. An Error becomes the session's message.
void attempt(Session& session, const std::function<void()>& what);

// Draws a slider's value as a bar from the left edge, behind the number. ImGui's grab would cover the number.

// Call it before the slider, and draw the slider with BareFrames.
void draw_slider_bar(double value, double min, double max, bool logarithmic);

// Hides the frames of sliders while it exists.
struct BareFrames {
    BareFrames();
    ~BareFrames();
    BareFrames(const BareFrames&) = delete;
    BareFrames& operator=(const BareFrames&) = delete;
};

}  // namespace clarity::ui
