// kernel_watch.hpp -- notices changes of kernel files on disk. After a change of revision(), call prepare() again.
#pragma once
#include <functional>
#include <utility>
#include <vector>

#include "base/files/file_watch.hpp"
#include "device/kernel_files.hpp"

namespace clarity {

// Calls `changed` after a change: see FileWatch.
class KernelWatch : public FileWatch {
 public:
    // plugins: their files are watched in addition to cl/. No file is watched if only embedded text counts.
    KernelWatch(const std::vector<const rt_plugin*>& plugins, std::function<void()> changed)
        : FileWatch(kernel_candidates(plugins), std::move(changed)) {}
};

}  // namespace clarity
