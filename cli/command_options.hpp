// command_options.hpp -- the options that one command alone has.
#pragma once
#include <CLI/CLI.hpp>

#include "cli/commands.hpp"

namespace clarity {

void add_render(CLI::App& app, RenderOptions& render);
void add_rays(CLI::App& app, TraceCommand& command);
void add_compare(CLI::App& app, CompareCommand& command);
void add_why(CLI::App& app, WhyCommand& why);
void add_check(CLI::App& app, CheckCommand& command);
void add_new_plugin(CLI::App& app, NewPluginCommand& command);
void add_lab(CLI::App& app, LabCommand& command);
void add_bench(CLI::App& app, BenchCommand& bench);

}  // namespace clarity
