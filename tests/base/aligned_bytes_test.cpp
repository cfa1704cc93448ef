#include "base/aligned_bytes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <thread>

using namespace clarity;

namespace {

constexpr size_t kMiB = size_t{1} << 20;

bool all_are(const AlignedBytes& bytes, unsigned char value) {
    const auto* const p = static_cast<const unsigned char*>(bytes.data());
    return std::all_of(p, p + bytes.bytes(), [value](unsigned char c) { return c == value; });
}

TEST(AlignedBytes, AreAlignedZeroedAndWritable) {
    for (const size_t bytes : {size_t{0}, size_t{1}, kMiB - 1, kMiB, kMiB + 1, 3 * kMiB - 1, 3 * kMiB, 4 * kMiB, 5 * kMiB + 17})
        for (int again = 0; again < 3; ++again) {  // the first block comes from the system, later ones were written to before
            AlignedBytes memory(bytes, true);
            ASSERT_EQ(memory.bytes(), bytes);
            ASSERT_EQ(reinterpret_cast<uintptr_t>(memory.data()) % 128, 0u);
            ASSERT_TRUE(all_are(memory, 0)) << bytes << ", time " << again;
            std::memset(memory.data(), 0xA5, bytes);
            ASSERT_TRUE(all_are(memory, 0xA5)) << bytes;
        }
}

TEST(AlignedBytes, BlocksInUseAreNotShared) {
    AlignedBytes a(3 * kMiB, false), b(3 * kMiB, false);
    std::memset(a.data(), 1, a.bytes());
    std::memset(b.data(), 2, b.bytes());
    EXPECT_TRUE(all_are(a, 1) && all_are(b, 2));
}

TEST(AlignedBytes, KeptMemoryIsLimited) {
    {
        const AlignedBytes huge(AlignedBytes::most_kept() + 4 * kMiB, false);
    }
    EXPECT_LE(AlignedBytes::kept(), AlignedBytes::most_kept());
    for (size_t size = AlignedBytes::most_kept() / 2; size > kMiB; size -= size / 8) {
        const AlignedBytes memory(size, false);
        ASSERT_LE(AlignedBytes::kept(), AlignedBytes::most_kept());
    }
    EXPECT_GT(AlignedBytes::kept(), 0u);
    void* const was = AlignedBytes(40 * kMiB, false).data();
    EXPECT_EQ(AlignedBytes(40 * kMiB, false).data(), was);
}

// As for a structure that moves: each build differs a little in size.
TEST(AlignedBytes, ABlockServesSimilarSizes) {
    void* const was = AlignedBytes(60 * kMiB + 1, false).data();
    EXPECT_EQ(AlignedBytes(61 * kMiB, false).data(), was);
    EXPECT_EQ(AlignedBytes(62 * kMiB, false).data(), was);
}

TEST(AlignedBytes, VectorsReturnTheirMemory) {
    {
        UninitializedVector<uint32_t> numbers;
        for (uint32_t i = 0; i < 3000000; ++i) numbers.push_back(i);  // makes the vector grow several times
        for (uint32_t i = 0; i < 3000000; ++i) ASSERT_EQ(numbers[i], i);
    }
    EXPECT_LE(AlignedBytes::kept(), AlignedBytes::most_kept());
    EXPECT_GE(AlignedBytes::kept(), 3000000 * sizeof(uint32_t));
}

TEST(AlignedBytes, ThreadsMayAllocateAtTheSameTime) {
    std::atomic<int> wrong{0};
    const auto work = [&](unsigned char mine) {
        for (int i = 0; i < 200; ++i) {
            AlignedBytes memory((1 + i % 5) * kMiB, i % 2 == 0);
            auto* const p = static_cast<unsigned char*>(memory.data());
            if (i % 2 == 0 && p[i] != 0) ++wrong;
            std::memset(p, mine, 4096);
            std::this_thread::yield();
            if (!std::all_of(p, p + 4096, [mine](unsigned char c) { return c == mine; })) ++wrong;
        }
    };
    std::thread a(work, 1), b(work, 2), c(work, 3);
    a.join();
    b.join();
    c.join();
    EXPECT_EQ(wrong, 0);
}

}  // namespace
