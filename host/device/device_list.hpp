// device_list.hpp -- functions that listing and choosing devices share.
#pragma once
#include <sys/types.h>

#include <cstddef>
#include <vector>

#include "device/device.hpp"

namespace clarity {

inline constexpr const char* kInstallDriver =
    "install an OpenCL driver: on Debian `apt-get install pocl-opencl-icd` runs on every CPU, a GPU needs its vendor's "
    "(`clinfo -l` shows what is found)";

// Whether `text` contains `part`, ignoring case.
bool says(const std::string& text, const std::string& part);

// Gives each thread of PoCL a core of its own.

// The threads of this process, in the order in which they started.
std::vector<pid_t> thread_ids();

// Pins each thread that has started since `before` was taken to one of the cores that this process may use, by turns. PoCL's
// threads start with its devices. Unpinned, two of them may share a core, which halves the speed of a launch of a few
// milliseconds: the system's scheduler needs longer than that to separate them. PoCL's own way, POCL_AFFINITY=1, takes cores 0,
// 1, ..., and fails where a process may not use these; if that is set to anything, this does nothing.
void pin_threads_since(const std::vector<pid_t>& before, size_t expected);

}  // namespace clarity
