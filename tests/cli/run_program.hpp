// run_program.hpp -- runs the built program as a user would, and collects its output.
#pragma once
#include <map>
#include <string>
#include <vector>

struct ProgramResult {
    int exit_code = -1;  // 128 + signal if a signal killed it
    std::string out, err;
    double seconds = 0;
    double seconds_after_signal = 0;  // of `seconds`, those since the signal was due; 0: it never was
};

struct RunOptions {
    std::map<std::string, std::string> environment;  // added to the test's own; "" removes a variable
    // When `signal` is sent: once all that are set are true.
    double signal_after_s = -1;        // seconds after the start
    std::string signal_when;           // stderr contains this text
    std::string signal_when_made;      // this file is there
    int signal = 0;                    // 0: none is sent, but its time is taken
    bool terminal = false;             // make stderr a terminal (its text then has CR LF)
    double limit_s = 300;              // then the program is killed, and the exit code is 137
    std::vector<std::string> wrapper;  // words before the program: a tool which runs it
    std::string stdout_path;           // file which stdout is written to instead of `out`
};

// Runs the program which CLARITY_WORKER names: `clarity` of the build.
ProgramResult run_program(const std::vector<std::string>& arguments, const RunOptions& options = {});
