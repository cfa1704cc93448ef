// setting_rows.hpp -- rows drawn from the settings table and from plugins' tables of parameters.
#pragma once
#include "render/settings/settings.hpp"
#include "rt_plugin.h"

namespace clarity::ui {

// A row of the settings table. Returns whether `settings` changed. What makes the host rebuild or recompile changes when the
// mouse lets go; the rest while it drags.
bool setting_row(const Setting& row, Settings& settings);
// The same for a plugin's parameter.
bool parameter_row(const rt_param& param, double& value);

}  // namespace clarity::ui
