#include "host_build.hpp"

#include <algorithm>
#include <vector>

#include "clarity_bvh/build/morton_order.hpp"
#include "rt_plugin.hpp"

namespace lbvh {
namespace {

using clarity::bvh::CurveKey;
using clarity::bvh::order_along_curve;

// The last place of the left child of the places first .. last: where the highest bit changes that they do not share.
uint32_t middle_of(const std::vector<CurveKey>& keys, uint32_t first, uint32_t last) {
    const uint64_t differ = keys[first].code ^ keys[last].code;
    uint64_t bit = uint64_t{1} << 63;
    if (differ != 0) {
        while (!(differ & bit)) bit /= 2;
        return static_cast<uint32_t>(std::partition_point(keys.begin() + first, keys.begin() + last + 1,
                                                          [&](const CurveKey& key) { return !(key.code & bit); }) -
                                     keys.begin()) -
               1;
    }
    while (!((first ^ last) & bit)) bit /= 2;  // equal codes: by the place
    return static_cast<uint32_t>((last & ~(bit - 1)) - 1);
}

void join(const rt_topology_node& from, rt_topology_node& to) {
    for (int a = 0; a < 3; ++a) {
        to.lo[a] = std::min(to.lo[a], from.lo[a]);
        to.hi[a] = std::max(to.hi[a], from.hi[a]);
    }
}

// Writes the 2 * count - 1 nodes of a group from nodes[base] on. first_ref: where its refs begin.
void write_tree(const rt_prim* prims, const std::vector<CurveKey>& keys, rt_topology_node* nodes, rt_u32 base, rt_u32 first_ref,
                rt_u32* refs) {
    struct Range {
        uint32_t node, first, last;
    };
    const auto count = static_cast<uint32_t>(keys.size());
    const uint32_t leaves = base + count - 1;
    for (uint32_t i = 0; i < count; ++i) {
        const rt_prim& prim = prims[keys[i].number];
        refs[first_ref + i] = prim.ref;
        rt_topology_node& leaf = nodes[leaves + i];
        std::copy_n(prim.lo, 3, leaf.lo);
        std::copy_n(prim.hi, 3, leaf.hi);
        leaf.left = first_ref + i;
        leaf.right = RT_TOPOLOGY_LEAF | 1u;
    }
    std::vector<Range> open;
    std::vector<uint32_t> order;  // parents before children
    order.reserve(count);
    if (count > 1) open.push_back({0, 0, count - 1});
    while (!open.empty()) {
        const Range at = open.back();
        open.pop_back();
        order.push_back(at.node);
        const uint32_t middle = middle_of(keys, at.first, at.last);
        rt_topology_node& node = nodes[base + at.node];
        node.left = at.first == middle ? leaves + middle : base + middle;
        node.right = at.last == middle + 1 ? leaves + middle + 1 : base + middle + 1;
        if (at.first < middle) open.push_back({middle, at.first, middle});
        if (middle + 1 < at.last) open.push_back({middle + 1, middle + 1, at.last});
    }
    for (size_t i = order.size(); i-- > 0;) {
        rt_topology_node& node = nodes[base + order[i]];
        std::copy_n(nodes[node.left].lo, 3, node.lo);
        std::copy_n(nodes[node.left].hi, 3, node.hi);
        join(nodes[node.right], node);
    }
}

}  // namespace

int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out) {
    uint64_t primitives = 0, nodes = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        primitives += input->groups[g].count;
        nodes += input->groups[g].count ? 2 * uint64_t{input->groups[g].count} - 1 : 0;
    }
    if (primitives > RT_REF_INDEX_MAX) return host->fail(host->ctx, "lbvh takes at most 268435455 primitives");
    rt_topology_node* const all = rt::nodes(out, nodes);
    rt_u32* const refs = rt::refs(out, primitives);
    rt_u32 base = 0, first_ref = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        const rt_group group = input->groups[g];
        if (group.count == 0) {
            rt::root(out, g, RT_NONE);
            continue;
        }
        if (!host->progress(host->ctx, float(first_ref) / float(primitives))) return RT_CANCELLED;
        const rt_prim* const prims = input->prims + group.first;
        write_tree(prims, order_along_curve(host, prims, group.count), all, base, first_ref, refs);
        rt::root(out, g, base);
        base += 2 * group.count - 1;
        first_ref += group.count;
    }
    return RT_OK;
}

}  // namespace lbvh
