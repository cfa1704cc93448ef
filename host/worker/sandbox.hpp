// sandbox.hpp -- restricts the worker process before it reads a file. Linux only.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace clarity::worker {

// What a worker does, which decides what it may do.
enum class WorkerKind {
    parser,   // importers: reads the named files, no more; little of the system is needed
    builder,  // builders of structures: reads no files at all
    loader,   // opens a library that nobody trusts: as a parser, and maps code. To be followed by `builder`
    driver    // kernels: OpenCL drivers start compilers, write caches, talk to devices and reserve terabytes of addresses
};

struct WorkerLimits {
    uint64_t memory_bytes = 0;       // memory that it may map in addition to the present one; 0: no limit
    uint64_t most_memory_bytes = 0;  // the parent may raise memory_bytes up to this while the worker runs
    uint64_t cpu_s = 0;              // processor time in seconds
    uint64_t stack_bytes = 64u << 20;
};

// Restricts this process for good, including threads that start later. Afterwards it has no network, cannot start programs or
// processes, cannot write or change files, and reads only files in `folders` and the named `files` (canonical paths). Memory,
// processor time and stack are limited, and a crash writes no core file. Logs a line for each restriction that this kernel
// cannot enforce. A worker of kind `driver` is less restricted: it has no network and no tracing of other processes, and only
// its processor time and stack are limited here. Its parent watches its resident memory.
void enter_sandbox(WorkerKind kind, const std::vector<std::string>& folders = {}, const std::vector<std::string>& files = {},
                   const WorkerLimits& limits = {});

// Restricts this process to compilers and what they start, each of them to these limits: no network; what is in `folders` is
// read and run; only in the folder `work` anything is written, in files of at most file_bytes.
void enter_tool_sandbox(const std::vector<std::string>& folders, const std::string& work, const WorkerLimits& limits,
                        uint64_t file_bytes);

// Whether this kernel keeps a worker from files, so that a stranger's build cannot read the teacher's. Changes nothing.
bool restricts_files();

// Lifts the limit on file sizes, which would also hold for the file in memory that takes the result.
void allow_writing_result();

namespace detail {
// Both return nothing on success, otherwise why the kernel refused.
Problem restrict_system_calls(WorkerKind kind);
// work: a folder in which all is allowed, or "". With one, what is in `folders` may be run.
Problem restrict_files(const std::vector<std::string>& folders, const std::vector<std::string>& files,
                       const std::string& work = {});
}  // namespace detail

}  // namespace clarity::worker
