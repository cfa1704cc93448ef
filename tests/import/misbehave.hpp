// misbehave.hpp -- things that damaged files and hostile code do to a process.
#pragma once
#include <string>

namespace test_importer {

// Crashes, hangs and so on. Does not return, or throws; returns false only if `what` is unknown.
bool misbehave(const std::string& what, const std::string& argument);

// Tries something that a parser must not do. Returns true if `what` is known; `outcome` is then "worked" or the system's error.
bool try_forbidden(const std::string& what, const std::string& argument, std::string& outcome);

}  // namespace test_importer
