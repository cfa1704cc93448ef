#include "base/parallel_for.hpp"
#include "support/clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

TEST(ParallelFor, RunsEachIndexOnce) {
    for (const uint32_t count : {0u, 1u, 2u, 1000u, 100000u}) {
        std::vector<std::atomic<int>> runs(count);
        clarity::parallel_for(count, [&](uint32_t i) { ++runs[i]; });
        for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(runs[i], 1) << i << " of " << count;
    }
}

TEST(ParallelFor, Nests) {
    std::atomic<uint64_t> sum{0};
    clarity::parallel_for(16, [&](uint32_t a) {
        clarity::parallel_for(
            16, [&](uint32_t b) { clarity::parallel_for(16, [&](uint32_t c) { sum += uint64_t{a} * 256 + b * 16 + c; }); });
    });
    EXPECT_EQ(sum, uint64_t{4096} * 4095 / 2);
}

// A body that holds a lock while it waits for an inner loop must not be given another iteration of the outer loop: it would
// lock again.
TEST(ParallelFor, AWaitingBodyIsNotHandedAnotherOuterOne) {
    static thread_local int depth = 0;
    std::atomic<int> deepest{0};
    clarity::parallel_for(64, [&](uint32_t) {
        ++depth;
        deepest = std::max(deepest.load(), depth);
        clarity::parallel_for(64, [](uint32_t) { std::this_thread::sleep_for(std::chrono::microseconds(20)); });
        --depth;
    });
    EXPECT_EQ(deepest, 1);
}

TEST(ParallelFor, RethrowsTheLowestOfSeveralExceptions) {
    for (int round = 0; round < 50; ++round) {
        try {
            clarity::parallel_for(1000, [](uint32_t i) {
                if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
            });
            FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& e) {
            ASSERT_STREQ(e.what(), "7");
        }
    }
}

TEST(ParallelFor, MayBeCalledByManyThreads) {
    std::atomic<uint64_t> sum{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 8; ++t) threads.emplace_back([&] { clarity::parallel_for(1000, [&](uint32_t i) { sum += i; }); });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(sum, 8u * 499500u);
}

// Nested loops share the threads: however deep they are nested, never more threads run than there are cores.
TEST(ParallelFor, NestsWithoutMoreThreadsThanCores) {
    std::atomic<int> running{0}, most{0};
    std::atomic<uint64_t> sum{0};
    clarity::parallel_for(8, [&](uint32_t a) {
        clarity::parallel_for(8, [&](uint32_t b) {
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

TEST(ParallelFor, ReleasesItsThreads) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
    for (int round = 0; round < 100; ++round) clarity::parallel_for(64, [](uint32_t) {});
    std::mutex mutex;
    std::set<std::thread::id> ids;
    std::atomic<bool> failed{false};
    clarity::parallel_for(64, [&](uint32_t) {
        const auto both = [&] {
            const std::lock_guard<std::mutex> lock(mutex);
            ids.insert(std::this_thread::get_id());
            return ids.size() >= 2;
        };
        if (!failed && !clarity::test::comes(both)) failed = true;
    });
    EXPECT_FALSE(failed) << "one thread does all iterations";
}

}  // namespace
