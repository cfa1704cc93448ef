// misbehave.hpp -- what damaged files and hostile code do to a process.
#pragma once
#include <string>

namespace test_importer {

// Crashes, hangs and the like, which do not return (or only by an exception). False if `what` is none of them.
bool misbehave(const std::string& what, const std::string& argument);

// Tries something that a parser has no business to do. True if `what` is known; `outcome` then is "worked" or the system's
// error.
bool try_forbidden(const std::string& what, const std::string& argument, std::string& outcome);

}  // namespace test_importer
