// option_groups.hpp -- options that several commands have.
#pragma once
#include <CLI/CLI.hpp>

#include "cli/command_line.hpp"
#include "cli/commands.hpp"

namespace clarity {

// Of a repeated option the last value counts, so that a user can override a shell alias.
CLI::Option* single(CLI::Option* option);
void add_common(CLI::App& app, CommonOptions& common);
// Returns the option of the files, so that a command may require them.
CLI::Option* add_scene(CLI::App& app, SceneOptions& scene);
void add_device(CLI::App& app, TraceOptions& trace);
// An option for each row of the table of settings, and --set.
void add_settings(CLI::App& app, std::vector<std::pair<std::string, std::string>>& settings, std::vector<std::string>& sets);
// Devices, the structure, settings and edits.
void add_trace(CLI::App& app, TraceOptions& trace);
void add_pose(CLI::App& app, PoseOptions& pose);
// "10%" is 0.1.
CLI::Validator percent();

}  // namespace clarity
