// man_page.hpp -- the help of all commands as a page for man(1), so that page and help have one text.
#pragma once
#include <string>

namespace CLI {
class App;
}

namespace clarity {

// The manual page of the program in the language of man(7). `app` has all subcommands and their options.
std::string man_page(const CLI::App& app, const std::string& version);

// Completion of commands, options and values in bash, from the options that the program knows.

// A script to be sourced by bash; it starts no process when it completes. `app` has all subcommands and their options.
std::string bash_completion(const CLI::App& app);

}  // namespace clarity
