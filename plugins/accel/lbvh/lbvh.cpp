// lbvh.cpp -- the plugin of the linear BVH: a binary tree along a Morton curve, which can be built on the device that traces
// it. bvh4 packs and traces it.
#include <algorithm>
#include <vector>

#include "clarity_bvh/build/morton_order.hpp"
#include "rt_device.hpp"
#include "rt_plugin.hpp"

namespace lbvh {
namespace {

using namespace clarity::bvh;
using rt::number;
using rt::of;

constexpr uint64_t kNodeBytes = 32;

// rt_device_build::topology: the steps of a build on the device. lbvh_build.cl has the kernels.
int32_t plan(const rt_host*, const rt_device_plan* plan, const rt_device_input* input, rt_device_topology* result) {
    const uint64_t n = input->count, each = rt::elements_each(plan);
    rt::DeviceSteps steps(plan);
    const rt_u32 order = steps.buffer(4 * n), nodes = steps.buffer(kNodeBytes * n), counts = steps.buffer(4 * n);
    if (n > 0) {
        const rt_u32 keys = steps.buffer(8 * n);
        steps.curve(input->prims, n, axis_bits(n), keys, order);
        if (n > 1) {
            const rt_u32 blocks = steps.blocks(input->prims, order, n);
            steps.launch("lbvh_nodes", (n - 1 + each - 1) / each,
                         {of(keys), of(blocks), number(n), number(each), of(nodes), of(counts)});
        }
    }
    result->nodes = nodes;
    result->counts = counts;
    result->order = order;
    result->depth = depth_bound(n);
    return steps.result();
}

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

rt_u32 write_inner(const CurveGroup& group) {
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

// rt_accel::topology: the tree of lbvh_build.cl, built on the host, for devices and commands that do not build there. Node i of
// a group is node i of Karras's numbering; the leaves follow, in order along the curve.
int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out) {
    return build_along_curve(host, input, out, "lbvh", write_inner);
}

constexpr rt_cl_file kFiles[] = {
#include "lbvh.inc"
};
constexpr rt_accel kAccel = rt::topology("bvh4", rt::guarded<topology>, rt::Traits());
constexpr rt_device_build kBuild = rt::device_topology(rt::file(kFiles, "lbvh_build.cl"), rt::guarded<plan>);
constexpr rt_extension kExtensions[] = {rt::extension(kBuild), rt::kNoMoreExtensions};
static_assert(kBuild.kernels.text, "the kernel file is embedded");

}  // namespace
}  // namespace lbvh

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("lbvh", "Linear BVH along a Morton curve, for builds on the device", "1.0.0",
                     "Karras 2012, Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", lbvh::kAccel),
    lbvh::kExtensions);
