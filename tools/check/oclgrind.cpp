#include "tools/check/oclgrind.hpp"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/text.hpp"

namespace clarity::check {

Launch in_oclgrind(const std::string& worker, const std::string& log) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::string program = folder + "/oclgrind";
        if (access(program.c_str(), X_OK) == 0) return {program, {"--data-races", "--log", log, worker}};
    }
    return {};
}

Outcome with_findings(const Outcome& outcome, const std::string& log) {
    constexpr int kMostLines = 6;
    std::ifstream file(log);
    std::string text, line;
    for (int lines = 0; lines < kMostLines && std::getline(file, line); ++lines) text += (text.empty() ? "" : " ") + line;
    if (text.empty() || outcome.kind != Outcome::Kind::passed) return outcome;
    return Outcome::failed("oclgrind says: " + printable_line(text));
}

}  // namespace clarity::check
