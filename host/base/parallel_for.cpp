#include "base/parallel_for.hpp"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace clarity {
namespace {

// Keeps the exception of the lowest index, so that a failing loop reports the same exception on every run.
class FirstException {
 public:
    // False if a body with a lower index failed: the result of this one does not matter any more.
    bool wanted(uint32_t i) const { return i < index_.load(std::memory_order_relaxed); }
    void keep(uint32_t i) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (i >= index_) return;
        index_ = i;
        exception_ = std::current_exception();
    }
    void rethrow() const {
        if (exception_) std::rethrow_exception(exception_);
    }

 private:
    std::mutex mutex_;
    std::atomic<uint64_t> index_{uint64_t{1} << 32};
    std::exception_ptr exception_;
};

#ifdef __SANITIZE_THREAD__
// ThreadSanitizer does not see how threads of TBB, which was not compiled for it, wait for each other, and would report every
// loop. So loops have threads of their own there; inner loops run on the thread that comes to them.
template <class Body>
void each_index(uint32_t count, const Body& body) {
    thread_local bool is_inside = false;
    std::atomic<uint32_t> next{0};
    const auto work = [&] {
        is_inside = true;
        for (uint32_t i; (i = next++) < count;) body(i);
    };
    std::vector<std::thread> threads;
    const uint32_t others = std::min(loop_threads(), count) - 1;
    for (uint32_t t = 0; !is_inside && t < others; ++t) threads.emplace_back(work);
    const bool was_inside = is_inside;
    work();
    is_inside = was_inside;
    for (std::thread& thread : threads) thread.join();
}
#else
// Isolated: a thread that waits for this loop does not run iterations of an outer loop. A body may therefore hold a lock or use
// thread-local scratch memory across its inner loop.
template <class Body>
void each_index(uint32_t count, const Body& body) {
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(uint32_t{0}, count, body); });
}
#endif

}  // namespace

unsigned loop_threads() {
    return static_cast<unsigned>(std::max(tbb::info::default_concurrency(), 1));
}

void parallel_for(uint32_t count, const std::function<void(uint32_t)>& body) {
    if (count == 0) return;
    if (count == 1) return body(0);
    FirstException first;
    const auto guarded = [&](uint32_t i) {
        if (!first.wanted(i)) return;
        try {
            body(i);
        } catch (...) {
            first.keep(i);
        }
    };
    each_index(count, guarded);
    first.rethrow();
}

}  // namespace clarity
