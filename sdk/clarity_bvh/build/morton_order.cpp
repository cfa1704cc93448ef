#include "clarity_bvh/build/morton_order.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>

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

int32_t build_along_curve(const rt_host* host, const rt_build_input* input, const rt_topology_output* out, const char* id,
                          const std::function<rt_u32(const CurveGroup&)>& write_inner) {
    uint64_t primitives = 0, node_count = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        primitives += input->groups[g].count;
        node_count += input->groups[g].count ? 2 * uint64_t{input->groups[g].count} - 1 : 0;
    }
    if (primitives > RT_REF_INDEX_MAX)
        return host->fail(host->ctx, (id + std::string(" takes at most 268435455 primitives")).c_str());
    rt_topology_node* const nodes = rt::nodes(out, node_count);
    rt_u32* const refs = rt::refs(out, primitives);
    rt_u32 base = 0, first_ref = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        const rt_u32 count = input->groups[g].count;
        if (count == 0) {
            rt::root(out, g, RT_NONE);
            continue;
        }
        if (!host->progress(host->ctx, float(first_ref) / float(primitives))) return RT_CANCELLED;
        const rt_prim* const prims = input->prims + input->groups[g].first;
        const std::vector<CurveKey> keys = order_along_curve(host, prims, count);
        const rt_u32 leaves = base + count - 1;
        for (rt_u32 i = 0; i < count; ++i) {
            const rt_prim& prim = prims[keys[i].number];
            refs[first_ref + i] = prim.ref;
            rt_topology_node& leaf = nodes[leaves + i];
            std::copy_n(prim.lo, 3, leaf.lo);
            std::copy_n(prim.hi, 3, leaf.hi);
            leaf.left = first_ref + i;
            leaf.right = RT_TOPOLOGY_LEAF | 1u;
        }
        rt::root(out, g, count > 1 ? write_inner({prims, keys, nodes, base, leaves}) : leaves);
        base += 2 * count - 1;
        first_ref += count;
    }
    return RT_OK;
}

}  // namespace clarity::bvh
