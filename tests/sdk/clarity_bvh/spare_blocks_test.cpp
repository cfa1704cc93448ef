#include "clarity_bvh/base/spare_blocks.hpp"
#include "support/clock.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

using clarity::bvh::SpareBlocks;
using namespace std::chrono_literals;

namespace {

void* large_block(size_t bytes) {
    void* const p = std::aligned_alloc(SpareBlocks::kLarge, bytes);
    EXPECT_NE(p, nullptr);
    return p;
}
void release(void* p, size_t) {
    std::free(p);
}
// They wait: static objects of the program do, too.
SpareBlocks& waiting(SpareBlocks::Clock::duration idle) {
    return *new SpareBlocks(8 * SpareBlocks::kLarge, release, idle);
}

TEST(SpareBlocks, AreNotOfferedToTheSystemBetweenTwoBuilds) {
    SpareBlocks& blocks = waiting(1h);
    void* const p = large_block(SpareBlocks::kLarge);
    blocks.give(p, SpareBlocks::kLarge);
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(blocks.offered(), 0u);
    EXPECT_EQ(blocks.take(SpareBlocks::kLarge), p);
    std::free(p);
}

TEST(SpareBlocks, AreOfferedOnceNobodyUsesThem) {
    SpareBlocks& blocks = waiting(1ms);
    const size_t bytes = SpareBlocks::kLarge;
    for (int again = 0; again < 3; ++again) {  // the thread that waits has ended in between, or not
        void* const p = large_block(bytes);
        void* const q = large_block(2 * bytes);
        blocks.give(p, bytes);
        blocks.give(q, 2 * bytes);
        EXPECT_TRUE(clarity::test::comes([&] { return blocks.offered() == 3 * bytes; }));
        EXPECT_EQ(blocks.sum(), 3 * bytes);
        EXPECT_EQ(blocks.take(bytes), p);
        EXPECT_EQ(blocks.take(2 * bytes), q);
        EXPECT_EQ(blocks.offered(), 0u);
        static_cast<char*>(p)[bytes - 1] = 1;
        std::free(p);
        std::free(q);
    }
}

TEST(SpareBlocks, SmallOnesAreNever) {
    SpareBlocks& blocks = waiting(0ms);
    void* const p = std::malloc(4096);
    blocks.give(p, 4096);
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(blocks.offered(), 0u);
    EXPECT_EQ(blocks.take(4096), p);
    std::free(p);
}

}  // namespace
