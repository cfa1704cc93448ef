// kernel_watch.hpp -- notices when the text of a kernel changes on disk: a new revision() is a reason to prepare again.
#pragma once
#include <functional>
#include <utility>
#include <vector>

#include "base/file_watch.hpp"
#include "device/kernel_files.hpp"

namespace clarity {

class KernelWatch : public FileWatch {
 public:
    // accels: whose files are watched besides cl/. No file at all where only the text inside the program counts.
    KernelWatch(const std::vector<const rt_plugin*>& accels, std::function<void()> changed)
        : FileWatch(kernel_candidates(accels), std::move(changed)) {}
};

}  // namespace clarity
