// primitives_test.cpp -- sort, scan and reduction on a device, against those of the standard library. Both forms of the kernels
// run on the default device, whatever it is, with buffers that are taken once.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "base/error.hpp"
#include "rt_plugin.h"
#include "structures/on_device/device_sort.hpp"

using namespace clarity;

namespace {

constexpr uint64_t kMost = 262145;  // more than 128 tiles of a sort
const uint64_t kCounts[] = {0, 1, 2, 31, 255, 256, 257, 2047, 2048, 2049, 4096, 4097, 16384, 16385, 70001, kMost};

class DeviceBuild : public ::testing::TestWithParam<BuildForm> {
 protected:
    static std::shared_ptr<Device> device() {
        static const auto opened = std::make_shared<Device>(choose_device(""));
        return opened;
    }
    template <class T>
    void upload(const cl::Buffer& buffer, const std::vector<T>& values) {
        if (!values.empty()) queue_.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(T), values.data());
    }
    template <class T>
    std::vector<T> download(const cl::Buffer& buffer, uint64_t count) {
        std::vector<T> values(count);
        if (count) queue_.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), values.data());
        return values;
    }
    BuildKernels kernels_{device(), GetParam()};
    Queue& queue_ = device()->queue();
    std::mt19937_64 random_{20};

    // keys: as wide as T. Sorts by all counts of kCounts, with keys of which many are equal and keys that differ everywhere.
    template <class T>
    void sorts(SortKeys width, std::initializer_list<unsigned> widths) {
        DeviceSort sort(kernels_, kMost, width);
        const cl::Buffer keys = kernels_.buffer(kMost * sizeof(T)), values = kernels_.buffer(kMost * 4);
        for (const unsigned bits : widths)
            for (const uint64_t count : kCounts)
                for (const bool equal : {false, true}) {
                    std::vector<T> key(count);
                    std::vector<uint32_t> value(count), order(count);
                    for (T& k : key) k = static_cast<T>(equal ? random_() % 3 * 77 : random_());
                    for (uint32_t& v : value) v = static_cast<uint32_t>(random_());
                    upload(keys, key);
                    upload(values, value);
                    sort.run(keys, values, count, bits);
                    const T mask = static_cast<T>(bits == 8 * sizeof(T) ? ~T{0} : (T{1} << bits) - 1);
                    std::iota(order.begin(), order.end(), 0u);
                    std::stable_sort(order.begin(), order.end(),
                                     [&](uint32_t a, uint32_t b) { return (key[a] & mask) < (key[b] & mask); });
                    const auto sorted_keys = download<T>(keys, count);
                    const auto sorted_values = download<uint32_t>(values, count);
                    for (uint64_t i = 0; i < count; ++i) {
                        ASSERT_EQ(sorted_keys[i], key[order[i]]) << i << " of " << count << ", " << bits << " bits";
                        ASSERT_EQ(sorted_values[i], value[order[i]]) << i << " of " << count << ", " << bits << " bits";
                    }
                }
    }
};

TEST_P(DeviceBuild, SortsKeysOf32Bits) {
    sorts<uint32_t>(SortKeys::bits32, {30, 32, 1, 17});
}
TEST_P(DeviceBuild, SortsKeysOf64Bits) {
    sorts<uint64_t>(SortKeys::bits64, {63, 64, 36});
}

TEST_P(DeviceBuild, ScansNumbers) {
    const uint64_t most = 2000003;  // two levels
    DeviceScan scan(kernels_, most);
    const cl::Buffer buffer = kernels_.buffer(4 * most);
    std::vector<uint64_t> counts(std::begin(kCounts), std::end(kCounts));
    counts.push_back(1000000);
    counts.push_back(most);
    for (const uint64_t count : counts) {
        std::vector<uint32_t> values(count), expected(count);
        for (uint32_t& v : values) v = static_cast<uint32_t>(random_() >> 40);
        upload(buffer, values);
        scan.run(buffer, count);
        std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
        ASSERT_TRUE(download<uint32_t>(buffer, count) == expected) << count;
    }
}

TEST_P(DeviceBuild, ReducesBoxes) {
    DeviceReduce reduce(kernels_);
    const cl::Buffer boxes = kernels_.buffer(kMost * sizeof(rt_prim)), result = kernels_.buffer(sizeof(DeviceBounds));
    std::uniform_real_distribution<float> place(-1000, 1000), size(0, 3);
    for (const uint64_t count : kCounts) {
        const uint64_t first = count < kMost ? 3 % (kMost - count) : 0;
        std::vector<rt_prim> prims(first + count);
        DeviceBounds expected;
        for (int a = 0; a < 3; ++a) {
            expected.lo[a] = expected.least_centre[a] = INFINITY;
            expected.hi[a] = expected.greatest_centre[a] = -INFINITY;
        }
        for (uint64_t i = 0; i < prims.size(); ++i)
            for (int a = 0; a < 3; ++a) {
                const float lo = prims[i].lo[a] = i < first ? -5000 : place(random_);
                const float hi = prims[i].hi[a] = lo + size(random_), centre = 0.5f * lo + 0.5f * hi;
                if (i < first) continue;
                expected.lo[a] = std::min(expected.lo[a], lo);
                expected.hi[a] = std::max(expected.hi[a], hi);
                expected.least_centre[a] = std::min(expected.least_centre[a], centre);
                expected.greatest_centre[a] = std::max(expected.greatest_centre[a], centre);
            }
        upload(boxes, prims);
        reduce.run(boxes, first, count, result);
        const DeviceBounds found = download<DeviceBounds>(result, 1)[0];
        for (int a = 0; a < 3; ++a) {
            EXPECT_EQ(found.lo[a], expected.lo[a]) << count;
            EXPECT_EQ(found.hi[a], expected.hi[a]) << count;
            // A compiler may fuse the multiplication and the addition.
            EXPECT_TRUE(count == 0 || std::abs(found.least_centre[a] - expected.least_centre[a]) < 1e-3f) << count;
            EXPECT_TRUE(count == 0 || std::abs(found.greatest_centre[a] - expected.greatest_centre[a]) < 1e-3f) << count;
        }
    }
}

TEST_P(DeviceBuild, RefusesMoreThanThereIsMemoryFor) {
    DeviceSort sort(kernels_, 100, SortKeys::bits32);
    const cl::Buffer keys = kernels_.buffer(404), values = kernels_.buffer(404);
    EXPECT_THROW(sort.run(keys, values, 101, 30), Error);
    EXPECT_THROW(sort.run(keys, values, 100, 33), Error);
    DeviceScan scan(kernels_, 100);
    EXPECT_THROW(scan.run(keys, 101), Error);
}

INSTANTIATE_TEST_SUITE_P(, DeviceBuild, ::testing::Values(BuildForm::groups, BuildForm::serial),
                         [](const auto& info) { return info.param == BuildForm::groups ? "groups" : "serial"; });

}  // namespace
