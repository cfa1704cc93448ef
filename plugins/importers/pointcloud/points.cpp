#include "points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "../common/mesh_arrays.hpp"

namespace pointcloud {
namespace {

// Every third bit is one of x's.
uint64_t spread(uint64_t x) {
    x &= 0x1FFFFF;
    x = (x | x << 32) & 0x1F00000000FFFF;
    x = (x | x << 16) & 0x1F0000FF0000FF;
    x = (x | x << 8) & 0x100F00F00F00F00F;
    x = (x | x << 4) & 0x10C30C30C30C30C3;
    return (x | x << 2) & 0x1249249249249249;
}

rt_u32 byte_of(float linear) {
    const double x = std::clamp(double(linear), 0.0, 1.0);
    return static_cast<rt_u32>(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

}  // namespace

double spacing(const std::vector<float>& positions) {
    const size_t count = positions.size() / 3;
    const importers::Box box(positions);
    if (count < 2 || !(box.size() > 0)) return 0;
    // Along a Morton curve most neighbours are near in the list. Too large a distance where they are not moves the median
    // little.
    constexpr size_t kSamples = 4096, kWindow = 48;
    std::vector<std::pair<uint64_t, size_t>> order(count);
    for (size_t i = 0; i < count; ++i) {
        uint64_t code = 0;
        for (size_t k = 0; k < 3; ++k)
            code |= spread(static_cast<uint64_t>((double(positions[3 * i + k]) - box.lo[k]) / box.size() * 0x1FFFFF)) << k;
        order[i] = {code, i};
    }
    std::sort(order.begin(), order.end());
    std::vector<double> distances;
    for (size_t s = 0, samples = std::min(count, kSamples); s < samples; ++s) {
        const size_t at = s * count / samples;
        double nearest = HUGE_VAL;
        for (size_t j = at - std::min(at, kWindow), end = std::min(count, at + kWindow + 1); j < end; ++j) {
            double square = 0;
            for (size_t k = 0; k < 3; ++k) {
                const double d = double(positions[3 * order[j].second + k]) - double(positions[3 * order[at].second + k]);
                square += d * d;
            }
            if (square > 0) nearest = std::min(nearest, square);
        }
        if (nearest < HUGE_VAL) distances.push_back(std::sqrt(nearest));
    }
    if (distances.empty()) return 0;
    const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

Palette palette_of(const std::vector<float>& colors) {
    constexpr size_t kMost = 1u << 15;
    const size_t count = colors.size() / 4;
    std::vector<rt_u32> keys(count);
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < 3; ++k) keys[i] = keys[i] << 8 | byte_of(colors[4 * i + k]);
    Palette palette;
    std::vector<rt_u32> different;
    for (rt_u32 drop = 0;; ++drop) {
        const rt_u32 channel = 0xFFu >> drop << drop, mask = channel << 16 | channel << 8 | channel;
        for (rt_u32& key : keys) key &= mask;
        different = keys;
        std::sort(different.begin(), different.end());
        different.erase(std::unique(different.begin(), different.end()), different.end());
        if (drop == 0) palette.different = different.size();
        if (different.size() <= kMost) break;
    }
    std::vector<double> sums(4 * different.size());
    for (size_t i = 0; i < count; ++i) {
        const auto at = std::lower_bound(different.begin(), different.end(), keys[i]) - different.begin();
        palette.of_point.push_back(static_cast<rt_u32>(at));
        for (size_t k = 0; k < 3; ++k) sums[4 * size_t(at) + k] += double(colors[4 * i + k]);
        ++sums[4 * size_t(at) + 3];
    }
    for (size_t i = 0; i < sums.size(); i += 4)
        for (size_t k = 0; k < 3; ++k) palette.colors.push_back(static_cast<float>(sums[i + k] / sums[i + 3]));
    return palette;
}

}  // namespace pointcloud
