#include "plugin/thread_loop.hpp"

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace clarity {
namespace {

// Threads that may still be started, by all loops together.
std::atomic<int>& spare_threads() {
    static std::atomic<int> spare{std::max(1, static_cast<int>(std::thread::hardware_concurrency())) - 1};
    return spare;
}

bool take_spare_thread() {
    int have = spare_threads().load();
    while (have > 0)
        if (spare_threads().compare_exchange_weak(have, have - 1)) return true;
    return false;
}

}  // namespace

void thread_loop(uint32_t count, const std::function<void(uint32_t)>& body) {
    std::atomic<uint64_t> next{0};  // 64 bits: threads run past the end by one each
    const auto work = [&] {
        for (uint64_t i = next++; i < count; i = next++) body(static_cast<uint32_t>(i));
    };
    std::vector<std::thread> threads;
    for (uint32_t i = 1; i < count && take_spare_thread(); ++i) {
        try {
            threads.emplace_back([&] {
                work();
                ++spare_threads();  // at once: a slow sibling's inner loop can use it
            });
        } catch (const std::exception&) {  // the system gives no more threads: those that run do all of it
            ++spare_threads();
            break;
        }
    }
    work();
    for (std::thread& thread : threads) thread.join();
}

}  // namespace clarity
