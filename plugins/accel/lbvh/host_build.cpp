#include "host_build.hpp"

#include <algorithm>
#include <vector>

#include "clarity_bvh/build/morton_order.hpp"
#include "rt_plugin.hpp"

namespace lbvh {
namespace {

using clarity::bvh::CurveKey;

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

rt_u32 write_inner(const clarity::bvh::CurveGroup& group) {
    struct Range {
        uint32_t node, first, last;
    };
    const std::vector<CurveKey>& keys = group.keys;
    rt_topology_node* const nodes = group.nodes;
    const rt_u32 base = group.base, leaves = group.leaves;
    const auto count = static_cast<uint32_t>(keys.size());
    std::vector<Range> open;
    std::vector<uint32_t> order;  // parents before children
    order.reserve(count);
    open.push_back({0, 0, count - 1});
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
    return base;
}

}  // namespace

int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out) {
    return clarity::bvh::build_along_curve(host, input, out, "lbvh", write_inner);
}

}  // namespace lbvh
