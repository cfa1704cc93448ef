// compile_wire.hpp -- what the program and its compile worker say to each other through the worker's shared memory.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace clarity {

// Program to worker.
struct CompileJob {
    std::string source, options;
    std::string device, name, driver;  // id as `--device` takes it; the worker refuses a device of another name or driver
    uint32_t ends_on_zeros = 0;
    uint32_t wants_binary = 0;
    std::string pocl_cache;  // the folder that PoCL compiles into; empty: its own
};

// Worker to program.
struct CompileOutcome {
    enum State : uint32_t { compiled, failed, no_device };
    uint32_t state = compiled;
    int32_t error = 0;         // OpenCL's, if failed
    std::string log;           // the compiler's; why, if there is no device
    std::vector<char> binary;  // empty: not asked for, or the driver gives none
};

// Each replaces what the memory holds. Return why it failed; empty: it did not.
std::string write_compile_job(int fd, const CompileJob& job);
std::string write_compile_outcome(int fd, const CompileOutcome& outcome);
// The other process may have written anything.
std::string read_compile_job(int fd, CompileJob& job);
std::string read_compile_outcome(int fd, CompileOutcome& outcome);

}  // namespace clarity
