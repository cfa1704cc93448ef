#include "device/pocl_threads.hpp"

#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>

namespace clarity {

std::vector<pid_t> thread_ids() {
    std::vector<pid_t> ids;
    std::error_code error;
    for (std::filesystem::directory_iterator at("/proc/self/task", error), end; !error && at != end; at.increment(error))
        ids.push_back(static_cast<pid_t>(std::atol(at->path().filename().c_str())));
    std::sort(ids.begin(), ids.end());
    return ids;
}

void pin_threads_since(const std::vector<pid_t>& before, size_t expected) {
    cpu_set_t allowed;
    if (std::getenv("POCL_AFFINITY") || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    std::vector<size_t> cores;
    for (size_t core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &allowed)) cores.push_back(core);
    const std::vector<pid_t> now = thread_ids();
    std::vector<pid_t> started;
    std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(started));
    if (started.size() != expected) return;
    for (size_t i = 0; i < expected; ++i) {
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(cores[i % cores.size()], &one);
        sched_setaffinity(started[i], sizeof one, &one);  // may be refused, as in a sandbox: the thread then stays free
    }
}

}  // namespace clarity
