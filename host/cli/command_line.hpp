// command_line.hpp -- what may be typed, and its meaning.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/commands.hpp"

namespace clarity {

// Of every command.
struct CommonOptions {
    std::vector<std::string> plugin_files;
    bool verbose = false, quiet = false;
    std::string log_file;
};

struct CommandLine {
    CommonOptions common;
    // What to do; empty if there is nothing left to do (help, version).
    std::function<int(const PluginRegistry&)> command;
    bool needs_plugins = true;
    bool refused_plugin_is_fatal = true;  // one named by --plugin
};

// Prints help and version to stdout. Throws Error(usage) for what cannot be understood.
CommandLine parse_command_line(int argc, char** argv);

}  // namespace clarity
