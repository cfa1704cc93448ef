// sandbox.hpp -- what the worker process takes away from itself before it looks at a file. Linux.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace clarity::import {

struct WorkerLimits {
    uint64_t memory_bytes = 0;       // address space that may be added to what is mapped already; 0: no limit
    uint64_t most_memory_bytes = 0;  // up to which the parent may raise that while the worker runs
    uint64_t cpu_s = 0;              // processor time
    uint64_t stack_bytes = 64u << 20;
};

// Cannot be undone, and holds for threads to come. From then on: no network, no other programs or processes, no writing or
// changing of files, reading only in `folders` and of `files` (canonical paths), no core file; bounded memory, processor time,
// stack. Returns what this kernel cannot enforce, one line each.
std::vector<std::string> enter_sandbox(const std::vector<std::string>& folders, const std::vector<std::string>& files,
                                       const WorkerLimits& limits);

// The result goes into a file in memory, which no other limit would allow to grow.
void allow_writing_result();

namespace detail {
// Empty on success, else why the kernel refused.
std::string restrict_system_calls();
std::string restrict_files(const std::vector<std::string>& folders, const std::vector<std::string>& files);
}  // namespace detail

}  // namespace clarity::import
