// command_line.hpp -- parses the command line.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/commands.hpp"

namespace clarity {

// Options which every command has.
struct CommonOptions {
    std::vector<std::string> plugin_files;
    bool verbose = false, quiet = false;
    std::string log_file, timeline_file;
};

struct CommandLine {
    CommonOptions common;
    // Runs the command and returns the exit code; empty if there is nothing left to do (help, version).
    std::function<int(const PluginRegistry&)> command;
    bool needs_plugins = true;            // plugins must be loaded before the command runs
    bool lists_plugins = false;           // the command tells of refused libraries itself
    bool refused_plugin_is_fatal = true;  // end the program if a library named by --plugin was refused
};

// Parses the arguments. Prints help and version to stdout. Throws Error(usage) for invalid arguments.
CommandLine parse_command_line(int argc, char** argv);

}  // namespace clarity
