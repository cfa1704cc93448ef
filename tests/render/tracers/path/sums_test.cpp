// sums_test.cpp -- a pixel's samples are added in their order, without drift (cl/tracers/path/sum.h).
#include <gtest/gtest.h>

#include <cmath>

#include "render/tracers/path/lane_kernel.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// The two planes of a film of one pixel after `count` samples, of the color `even` and of `odd` in turns.
std::vector<float> summed(const cl_float4& even, const cl_float4& odd, unsigned count) {
    Device& device = LaneKernel::device();
    const std::string text = "#define RT_LANES 1\n#define RT_CPU 1\n" + kernel_text("lanes/lanes.h") + "\n" +
                             kernel_text("tracers/path/sum.h") +
                             "\nkernel void add(global float4 *film, const float4 even, const float4 odd, const uint count)\n"
                             "{ for (uint i = 0; i < count; ++i) rt_add_sample(film, 1, 0, i % 2u ? odd : even, i == 0u); }\n";
    cl::Kernel kernel(build_program(device, text, "-cl-std=CL1.2", "a test's sums").program, "add");
    std::vector<float> film(8);
    const cl::Buffer buffer(device.context(), CL_MEM_READ_WRITE, 32);
    kernel.setArg(0, buffer);
    kernel.setArg(1, even);
    kernel.setArg(2, odd);
    kernel.setArg(3, cl_uint(count));
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    device.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, 32, film.data());
    return film;
}

}  // namespace

// 0.1 and 1/3 are no floats: a plain sum of a million of them is off by 0.010 and 0.003.
TEST(PathSums, OfAMillionSamplesAreExact) {
    const cl_float4 light = {{0.5f, 0.1f, 1.0f / 3, 0}};
    const std::vector<float> film = summed(light, light, 1u << 20);
    ASSERT_EQ(film[3], 1u << 20);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(film[size_t(k)] / film[3] / double(light.s[k]), 1, 1e-7) << k;
}

// Rounding must not make it negative: the standard error would be no number.
TEST(PathSums, OfEqualSamplesHaveNoVariance) {
    for (const float value : {1.0f, 0.7f, 0.1f, 1.3f, 17.3f, 1e-3f}) {
        const std::vector<float> film = summed({{value, value, value, 0}}, {{value, value, value, 0}}, 1000);
        EXPECT_GE(film[7], 0) << value;
        EXPECT_LE(film[7] / film[3], 1e-12 * value * value) << value;
    }
}

TEST(PathSums, KnowTheirVariance) {
    const cl_float4 dark = {{0, 0, 0, 0}}, bright = {{2, 2, 2, 0}};
    const std::vector<float> film = summed(dark, bright, 1u << 16);
    EXPECT_NEAR(film[0] / film[3], 1, 1e-7);
    EXPECT_NEAR(film[7] / film[3], 1, 1e-4);
}
