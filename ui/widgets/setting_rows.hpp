// setting_rows.hpp -- rows drawn from the settings table and from the plugins' parameter tables.
#pragma once
#include "render/settings/settings.hpp"
#include "rt_plugin.h"

namespace clarity::ui {

// Draws a row of the settings table. Returns whether `settings` changed. Settings which make the host rebuild or recompile
// change when the mouse button is released, all others while the slider is dragged.
bool setting_row(const Setting& row, Settings& settings);
// The same for a parameter of a plugin.
bool parameter_row(const rt_param& param, double& value);

}  // namespace clarity::ui
