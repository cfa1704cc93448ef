#include "scene/motion/shutter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace clarity {
namespace {

// The part of sample i is i * step modulo their number. A step near the golden section of it spreads samples that follow each
// other; one without a common divisor reaches every part.
uint64_t step_of(uint64_t count) {
    constexpr double kGolden = 0.6180339887498949;
    auto step = std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(kGolden * static_cast<double>(count))));
    while (std::gcd(step, count) != 1) ++step;
    return step;
}

}  // namespace

double sample_time(const Shutter& shutter, unsigned sample) {
    if (shutter.samples <= 1 || !(shutter.open_s > 0)) return shutter.time_s;
    const uint64_t count = shutter.samples;
    // Sample 0 is near the picture's time: it is what a viewer sees first.
    const uint64_t part = (count / 2 + sample * step_of(count)) % count;
    return shutter.time_s + shutter.open_s * ((static_cast<double>(part) + 0.5) / static_cast<double>(count) - 0.5);
}

}  // namespace clarity
