#include "base/parallel_for.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <exception>
#include <mutex>

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

}  // namespace

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
    // Isolated: a thread that waits for this loop does not run iterations of an outer loop. A body may therefore hold a lock or
    // use thread-local scratch memory across its inner loop.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(uint32_t{0}, count, guarded); });
    first.rethrow();
}

}  // namespace clarity
