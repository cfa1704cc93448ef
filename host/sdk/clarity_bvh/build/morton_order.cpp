#include "clarity_bvh/build/morton_order.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

constexpr uint32_t kKeysPerTask = 1u << 14;  // primitives that one thread takes at once

template <class Body>  // do_one(i)
void each_key(const rt_host* host, uint32_t count, Body&& do_one) {
    rt::parallel_for(host, (count + kKeysPerTask - 1) / kKeysPerTask, [&](rt_u32 c) {
        for (uint32_t i = c * kKeysPerTask; i < std::min(count, (c + 1) * kKeysPerTask); ++i) do_one(i);
    });
}

// Puts two zeros between the bits of a cell number.
uint64_t spread(uint64_t x) {
    x = (x | x << 32) & 0x001F00000000FFFFull;
    x = (x | x << 16) & 0x001F0000FF0000FFull;
    x = (x | x << 8) & 0x100F00F00F00F00Full;
    x = (x | x << 4) & 0x10C30C30C30C30C3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

}  // namespace

std::vector<CurveKey> order_along_curve(const rt_host* host, const rt_prim* prims, uint32_t count) {
    const auto centre = [&](uint32_t i, int a) { return 0.5f * prims[i].lo[a] + 0.5f * prims[i].hi[a]; };
    float least[3] = {INFINITY, INFINITY, INFINITY}, extent = 0;
    for (int a = 0; a < 3; ++a) {
        float most = -INFINITY;
        for (uint32_t i = 0; i < count; ++i) {
            least[a] = std::min(least[a], centre(i, a));
            most = std::max(most, centre(i, a));
        }
        extent = std::max(extent, most - least[a]);
    }
    const auto cells = static_cast<float>(1u << axis_bits(count));
    const float scale = extent > 0 ? std::min(cells / extent, FLT_MAX) : 0;
    std::vector<CurveKey> keys(count);
    each_key(host, count, [&](uint32_t i) {
        uint64_t code = 0;
        for (int a = 0; a < 3; ++a) {
            const float cell = std::min(std::max((centre(i, a) - least[a]) * scale, 0.0f), cells - 1);
            code |= spread(static_cast<uint64_t>(cell)) << (2 - a);
        }
        keys[i] = {code, i};
    });
    std::sort(keys.begin(), keys.end());
    return keys;
}

}  // namespace clarity::bvh
