// widgets.hpp -- the rows that the panel is made of: label and widget, drawn from data.
#pragma once
#include <string>
#include <vector>

#include "render/settings.hpp"
#include "rt_plugin.h"
#include "ui/viewport.hpp"

namespace clarity {

// Starts a section with its title.
void section(const char* title);
// A label at the left with its help as tooltip; the next item fills the rest of the line.
void row_label(const char* label, const std::string& help = {});
// Label and a value that is only read.
void row_text(const char* label, const std::string& value, const std::string& help = {});
void tooltip(const std::string& text);  // of the last item
// An entry of an open list. Returns whether it was chosen anew.
bool option(const std::string& label, bool chosen);
// A slider whose value applies while it is dragged.
bool slider(const char* id, float& value, float min, float max, const char* format, bool logarithmic = false);
// Several lines of text in the dimmed colour.
void dim_text(const std::string& text);

// A row of the settings table. Returns whether `settings` changed. What makes the host rebuild or recompile changes when the
// mouse lets go; the rest while it drags.
bool setting_row(const Setting& row, Settings& settings);
// The same for a plugin's parameter.
bool parameter_row(const rt_param& param, double& value);

// Where rows and entries were drawn last, by label: for tests that click. nullptr if it never was.
const Rect* drawn_place(const std::string& label);

// "1.2 M", "871 k", "12": for counts. "3.4 MiB": for bytes.
std::string count_text(double count);
std::string bytes_text(double bytes);
std::string number_text(double value);

}  // namespace clarity
