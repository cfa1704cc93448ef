// machine_code_test.cpp -- the machine code which PoCL generates for the kernels on a CPU with 512-bit registers: packets must
// stay in these registers. They do not if the compiler falls back to one lane at a time, calls its library, or spills to a
// stack which is not aligned. The pictures are still correct then, but frames take twice as long.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;

namespace {

struct Code {
    int instructions = 0, wide = 0, calls = 0, lanes = 0, split_spills = 0;
};

bool has(const std::string& text, const char* what) {
    return text.find(what) != std::string::npos;
}

// Counts the instructions of our functions, the kernel's and those it calls. Calls are counted that leave them.
Code disassemble(const std::string& library) {
    Code code;
    const std::string command = "objdump -d --no-show-raw-insn '" + library + "'";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    char line[512];
    bool inside = false;
    while (pipe && std::fgets(line, sizeof line, pipe.get())) {
        const std::string text = line;
        if (has(text, ">:")) inside = has(text, " <rt_");
        if (!inside || !has(text, "\t")) continue;
        ++code.instructions;
        code.wide += has(text, "zmm");
        code.calls += has(text, "\tcall") && !has(text, " <rt_");
        // Not insertions: on some CPUs the compiler packs coordinates of one ray or of the camera by them.
        code.lanes += has(text, "vpextr") || has(text, "vextractps");
        code.split_spills += has(text, "zmm") && has(text, "(%rsp") && (has(text, "vmovup") || has(text, "vmovdqu"));
    }
    return code;
}

class MachineCode : public ::testing::TestWithParam<const char*> {};

}  // namespace

TEST_P(MachineCode, KeepsPacketsInWideRegisters) {
    std::ifstream cpu("/proc/cpuinfo");
    std::stringstream features;
    features << cpu.rdbuf();
    if (!has(features.str(), "avx512dq")) GTEST_SKIP() << "this CPU has no 512-bit registers";
    if (std::system("objdump --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "objdump is not installed";
    Scratch scratch;
    const std::string scene = scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"),
                      cache = scratch.path("pocl");
    RunOptions options;
    options.environment = {{"POCL_CACHE_DIR", cache}, {"CLARITY_COMPILE", "here"}};
    const ProgramResult result = run_program(
        {"render", scene, "-o", scratch.path("a.png"), "--size", "64x48", "--lanes", "16", "--accel", GetParam()}, options);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::string library;
    for (const auto& entry : fs::recursive_directory_iterator(cache))
        if (entry.path().filename() == "trace_iterative.so") library = entry.path().string();
    if (library.empty()) GTEST_SKIP() << "the device is not PoCL, or does not keep its kernels as libraries";

    const Code code = disassemble(library);
    ASSERT_GT(code.instructions, 1000);
    EXPECT_GT(code.wide * 3, code.instructions) << "of " << code.instructions << " instructions";
    EXPECT_EQ(code.calls, 0) << "the compiler's library is called, once per lane";
    EXPECT_LT(code.lanes, 16) << "single lanes are extracted from vectors";
    // A handful remains: queues are appended to at unaligned addresses.
    EXPECT_LT(code.split_spills, 40) << "the stack is not aligned for 512-bit spills";
}

INSTANTIATE_TEST_SUITE_P(Of, MachineCode, ::testing::Values("bvh2", "bvh8", "bvh8,incoherent=single"),
                         [](const auto& info) { return "case" + std::to_string(info.index); });
