// planted_faults.hpp -- faults in the kernels on purpose: tests must find them.
#pragma once
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "device/kernel_files.hpp"
#include "support/scratch.hpp"

namespace clarity::test {

// While it lives, kernels that this process and its children read have another text in one place of a file of cl/. Throws
// std::logic_error unless the file has `from` once.
class FaultyKernel {
 public:
    FaultyKernel(const std::string& file, const std::string& from, const std::string& to) {
        std::string text = kernel_text(file);
        const size_t at = text.find(from);
        if (at == std::string::npos) throw std::logic_error(file + " has no longer the text " + from);
        if (text.find(from, at + 1) != std::string::npos)
            throw std::logic_error(file + " has the text more than once: " + from);
        folder_.write("cl/" + file, text.replace(at, from.size(), to));
        environment_.set("CLARITY_KERNEL_PATH", folder_.path("cl"));
    }

 private:
    Scratch folder_;
    Environment environment_;
};

struct PlantedFault {
    std::string name, file, from, to;  // as of FaultyKernel
    std::string tests;                 // a filter: what may find it
};

// Runs tests of this very executable with the fault in the kernels, in a process of its own. Returns "" if one of them failed
// by its expectations; else why the fault counts as not found.
inline std::string why_not_found(const PlantedFault& fault) {
    const FaultyKernel planted(fault.file, fault.from, fault.to);
    const std::string command =
        "'" + std::filesystem::read_symlink("/proc/self/exe").string() + "' --gtest_filter='" + fault.tests + "' 2>&1";
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

// Every fault has its text in the kernels: short, so that ./test finds a table that a change of the kernels left behind.
template <typename Faults>
void expect_plantable(const Faults& faults) {
    for (const PlantedFault& fault : faults) EXPECT_NO_THROW(FaultyKernel(fault.file, fault.from, fault.to)) << fault.name;
}

// Tests find every fault in their quick form, which has fewer structures: they are run for each.
template <typename Faults>
void expect_found(const Faults& faults) {
    Environment few;
    few.set("CLARITY_QUICK_TESTS", "faults");
    for (const PlantedFault& fault : faults) EXPECT_EQ(why_not_found(fault), "") << fault.name;
}

}  // namespace clarity::test
