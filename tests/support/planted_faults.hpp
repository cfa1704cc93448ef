// planted_faults.hpp -- faults in the kernels on purpose: tests must find them.
#pragma once
#include <cstdio>
#include <string>

#include <sys/wait.h>

#include "device/kernel_files.hpp"
#include "support/scratch.hpp"

namespace clarity::test {

struct PlantedFault {
    std::string name, file, from, to;  // one place of a file of cl/
    std::string tests;                 // a filter: what may find it
};

// Runs tests of this very executable with the fault in the kernels, in a process of its own. Returns "" if one of them failed
// by its expectations; else why the fault counts as not found.
inline std::string why_not_found(const PlantedFault& fault) {
    std::string text = kernel_text(fault.file);
    const size_t at = text.find(fault.from);
    if (at == std::string::npos) return fault.file + " has no longer the text " + fault.from;
    if (text.find(fault.from, at + 1) != std::string::npos) return fault.file + " has the text more than once: " + fault.from;
    text.replace(at, fault.from.size(), fault.to);
    const Scratch scratch;
    scratch.write("cl/" + fault.file, text);
    const std::string command = "CLARITY_KERNEL_PATH='" + scratch.path("cl") + "' '" +
                                std::filesystem::read_symlink("/proc/self/exe").string() + "' --gtest_filter='" + fault.tests +
                                "' 2>&1";
    std::string output;
    FILE* const pipe = popen(command.c_str(), "r");
    if (!pipe) return "cannot run " + command;
    char part[4096];
    while (const size_t n = fread(part, 1, sizeof part, pipe)) output.append(part, n);
    const int status = pclose(pipe);
    if (output.find("C++ exception") != std::string::npos) return "the tests did not run: " + output;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 1) return "no test failed: " + output.substr(0, 2000);
    return "";
}

}  // namespace clarity::test
