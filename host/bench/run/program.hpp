// program.hpp -- runs a program of the bench's own and waits for its end.
#pragma once
#include <string>
#include <vector>

#include "base/progress.hpp"

namespace clarity::bench {

// What a started program leaves behind.
struct Ended {
    int status = 0;  // as waitpid() tells it
    double ms = 0;
};

// Starts words[0], found by PATH, in a process group of its own, so that Ctrl-C reaches only us. messages: a file for its
// stdout and stderr; "": its stderr is ours, and its stdout goes nowhere. A cancelled `progress` ends it by SIGTERM, and by
// SIGKILL if that does not help. Throws Cancelled then, and Error(failed) with `install` at the end if it cannot be started.
Ended run_program(std::vector<std::string> words, const std::string& messages, const char* install, const Progress& progress);

}  // namespace clarity::bench
