// oclgrind.hpp -- runs a worker in oclgrind, a simulated device that looks at every access of kernels to memory.
#pragma once
#include <string>
#include <vector>

#include "tools/check/steps.hpp"

namespace clarity::check {

// The check whose worker runs in oclgrind.
inline constexpr const char* kAccessCheck = "accesses.oclgrind";
inline constexpr const char* kAccessTried = "every access to memory, looked at by oclgrind";

// How a worker is started: `program WORDS... check-worker ...`.
struct Launch {
    std::string program;
    std::vector<std::string> words;
};
// A worker's program in oclgrind, which writes what it finds into `log`. The program is empty if oclgrind is not installed.
Launch in_oclgrind(const std::string& worker, const std::string& log);

// The outcome of a worker in oclgrind: failed if oclgrind wrote anything.
Outcome with_findings(const Outcome& outcome, const std::string& log);

}  // namespace clarity::check
