// bash_completion.hpp -- completion of commands, options and values in bash, from the options that the program knows.
#pragma once
#include <string>

namespace CLI {
class App;
}

namespace clarity {

// A script to be sourced by bash; it starts no process when it completes. `app` has all subcommands and their options.
std::string bash_completion(const CLI::App& app);

}  // namespace clarity
