#include "plugin/thread_loop.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace {

TEST(ThreadLoop, RunsEachIndexOnce) {
    for (const uint32_t count : {0u, 1u, 2u, 10000u}) {
        std::vector<std::atomic<int>> runs(count);
        clarity::thread_loop(count, [&](uint32_t i) { ++runs[i]; });
        for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(runs[i], 1) << i << " of " << count;
    }
}

// Nested loops share one budget: no more threads than cores at any moment, however deep.
TEST(ThreadLoop, NestsWithoutMoreThreadsThanCores) {
    std::atomic<int> running{0}, most{0};
    std::atomic<uint64_t> sum{0};
    clarity::thread_loop(8, [&](uint32_t a) {
        clarity::thread_loop(8, [&](uint32_t b) {
            const int now = ++running;
            for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            sum += a * 8 + b;
            --running;
        });
    });
    EXPECT_EQ(sum, 64u * 63u / 2);
    EXPECT_LE(most, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

TEST(ThreadLoop, GivesItsThreadsBack) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
    for (int round = 0; round < 100; ++round) clarity::thread_loop(64, [](uint32_t) {});
    std::mutex mutex;
    std::set<std::thread::id> ids;
    clarity::thread_loop(64, [&](uint32_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard<std::mutex> lock(mutex);
        ids.insert(std::this_thread::get_id());
    });
    EXPECT_GE(ids.size(), 2u);
}

}  // namespace
