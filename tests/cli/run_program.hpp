// run_program.hpp -- runs the built program as a user would and collects what it said.
#pragma once
#include <map>
#include <string>
#include <vector>

struct ProgramResult {
    int exit_code = -1;  // 128 + signal if one killed it
    std::string out, err;
    double seconds = 0;
};

struct RunOptions {
    std::map<std::string, std::string> environment;  // besides the test's own; "" removes a variable
    double signal_after_s = -1;                      // then `signal` is sent
    std::string signal_when;                         // ... or as soon as this stands in stderr
    int signal = 0;
    bool terminal = false;             // stderr is a terminal (its text comes with CR LF)
    double limit_s = 120;              // then it is killed, and the exit code is 137
    std::vector<std::string> wrapper;  // words before the program: a tool that runs it
    std::string stdout_path;           // written to instead of `out`
};

// The program that CLARITY_WORKER names: the build's `clarity`.
ProgramResult run_program(const std::vector<std::string>& arguments, const RunOptions& options = {});
