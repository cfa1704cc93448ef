// ploc.cpp -- the plugin of parallel locally-ordered clustering: a binary tree that is built from the leaves up, nearly as good
// as one by the surface area heuristic, and which can be built on the device that traces it. bvh4 packs and traces it.
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

#include "clarity_bvh/build/morton_order.hpp"
#include "rt_device.hpp"
#include "rt_plugin.hpp"

#define PLOC_INLINE inline
#define PLOC_HIGHEST_BIT(x) (63u - static_cast<rt_u32>(__builtin_clzll(x)))

namespace ploc {
namespace {

using namespace clarity::bvh;
using rt::number;
using rt::of;

// Places of the curve that one work-item, or thread, takes.
constexpr uint64_t kPart = 4096;
constexpr uint64_t parts_of(uint64_t count) {
    return (count + kPart - 1) / kPart;
}
constexpr uint64_t kPendingWords = 161;  // PLOC_OPEN + 1

// A tree that is higher becomes the radix tree, which is not. Trees of scenes were 15 to 75 nodes high.
constexpr uint32_t height_limit(uint64_t count) {
    return std::max(128u, depth_bound(count));
}

constexpr uint64_t kNodeBytes = 32, kPlaceBytes = 16;
constexpr uint64_t kGroupsPerUnit = 8;  // that join ranges of several groups

// rt_device_build::topology: the steps of a build on the device. ploc_build.cl has the kernels.
int32_t plan(const rt_host*, const rt_device_plan* plan, const rt_device_input* input, rt_device_topology* result) {
    const uint64_t n = input->count, groups = (n + plan->group_items - 1) / plan->group_items;
    rt::DeviceSteps steps(plan);
    const rt_u32 order = steps.buffer(4 * n), nodes = steps.buffer(kNodeBytes * n), counts = steps.buffer(4 * n);
    const rt_u32 root = steps.buffer(8);
    if (n > 0) {
        const rt_u32 keys = steps.buffer(8 * n);
        steps.curve(input->prims, n, axis_bits(n), keys, order);
        const rt_u32 places = steps.buffer(kPlaceBytes * n);
        const auto launch = [&](const char* kernel, uint64_t work_groups, const std::vector<rt_device_arg>& more) {
            std::vector<rt_device_arg> args = {of(input->prims), of(order),  of(keys), of(nodes),
                                               of(counts),       of(places), number(n)};
            args.insert(args.end(), more.begin(), more.end());
            steps.launch(kernel, work_groups, args);
        };
        const uint32_t limit = height_limit(n);
        if (plan->has_warps) {
            const rt_u32 waiting = steps.buffer(8 * (n + 1)), siblings = steps.buffer(4 * n),
                         of_radix_tree = steps.buffer(4 * n);
            if (n > 1) {
                launch("ploc_windows", groups, {of(waiting), of(root)});
                launch("ploc_climb", plan->units * kGroupsPerUnit, {of(waiting), of(siblings), of(root)});
                launch("ploc_limit", groups, {of(waiting), of(of_radix_tree), of(root), number(limit)});
            }
        } else {
            const uint64_t parts = parts_of(n);
            const rt_u32 pending = steps.buffer(4 * kPendingWords * parts);
            launch("ploc_parts", (parts + plan->group_items - 1) / plan->group_items, {number(kPart), of(pending), of(root)});
            launch("ploc_join_parts", 1, {number(kPart), of(pending), of(root), number(limit)});
        }
    }
    result->nodes = nodes;
    result->counts = counts;
    result->order = order;
    result->root = root;
    result->depth = height_limit(n);
    return steps.result();
}

using rt_u64 = uint64_t;

struct ploc_place;
// One group. Nodes are written where they stay.
struct ploc_tree {
    const rt_prim* prims;
    const CurveKey* keys;
    rt_topology_node* nodes;
    ploc_place* places;
};

#include "ploc_merge.h"

static_assert(PLOC_OPEN + 1 == kPendingWords, "both are the ranges of a part");

inline ploc_cluster ploc_load(const ploc_tree* t, ploc_place place) {
    const auto cluster = [&](const auto& box) {
        return ploc_cluster{box.lo[0], box.lo[1], box.lo[2], box.hi[0], box.hi[1], box.hi[2], place};
    };
    return place.code & PLOC_SINGLE ? cluster(t->prims[t->keys[place.code & ~PLOC_SINGLE].number])
                                    : cluster(t->nodes[place.code]);
}
inline void ploc_write(const ploc_tree* t, rt_u32 node, const ploc_cluster* box, rt_u32 left, rt_u32 right) {
    rt_topology_node& to = t->nodes[node];
    to.lo[0] = box->lo_x, to.lo[1] = box->lo_y, to.lo[2] = box->lo_z;
    to.hi[0] = box->hi_x, to.hi[1] = box->hi_y, to.hi[2] = box->hi_z;
    to.left = left;
    to.right = right;
}
inline ploc_place ploc_place_at(const ploc_tree* t, rt_u32 at) {
    return t->places[at];
}
inline void ploc_keep(const ploc_tree* t, rt_u32 at, ploc_place place) {
    t->places[at] = place;
}
inline rt_u64 ploc_code(const ploc_tree* t, rt_u32 at) {
    return t->keys[at].code;
}

// Returns the root of a group of two primitives or more. Its nodes are written, with children as in the kernels.
rt_u32 cluster_group(const rt_host* host, const ploc_tree& tree, rt_u32 count) {
    struct Part {
        rt_u32 starts[PLOC_OPEN + 1], open = 0;
    };
    std::vector<Part> parts(parts_of(count));
    std::vector<ploc_place> roots(parts.size());
    rt::parallel_for(host, static_cast<rt_u32>(parts.size()), [&](rt_u32 p) {
        Part& part = parts[p];
        const rt_u32 begin = p * kPart, end = std::min<rt_u32>(begin + kPart, count);
        for (rt_u32 i = begin; i < end; ++i)
            part.open = ploc_add(&tree, count, i, i + 1, false, part.starts, part.open, &roots[p]);
    });
    ploc_place root = roots[0];
    std::vector<rt_u32> starts(PLOC_OPEN + 1);
    rt_u32 open = 0;
    for (size_t p = 0; parts.size() > 1 && p < parts.size(); ++p)
        for (rt_u32 r = 0; r < parts[p].open; ++r) {
            const rt_u32 end = r + 1 < parts[p].open ? parts[p].starts[r + 1]
                                                     : static_cast<rt_u32>(std::min<uint64_t>((p + 1) * kPart, count));
            open = ploc_add(&tree, count, parts[p].starts[r], end, false, starts.data(), open, &root);
        }
    if (root.height <= height_limit(count)) return root.code;
    open = 0;
    for (rt_u32 i = 0; i < count; ++i) open = ploc_add(&tree, count, i, i + 1, true, starts.data(), open, &root);
    return root.code;
}

rt_u32 write_inner(const rt_host* host, const CurveGroup& group) {
    const auto count = static_cast<rt_u32>(group.keys.size());
    std::vector<ploc_place> places(count);
    rt_topology_node* const nodes = group.nodes + group.base;
    const rt_u32 root = cluster_group(host, {group.prims, group.keys.data(), nodes, places.data()}, count);
    const auto child = [&](rt_u32 code) {
        return code & PLOC_SINGLE ? group.leaves + (code & ~PLOC_SINGLE) : group.base + code;
    };
    for (rt_u32 i = 0; i + 1 < count; ++i) {
        nodes[i].left = child(nodes[i].left);
        nodes[i].right = child(nodes[i].right);
    }
    return group.base + root;
}

// rt_accel::topology. Inner nodes of a group come first, then the leaves in order along the curve.
int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out) {
    return build_along_curve(host, input, out, "ploc", [&](const CurveGroup& group) { return write_inner(host, group); });
}

constexpr rt_cl_file kFiles[] = {
#include "ploc.inc"
};
constexpr rt_accel kAccel = rt::topology("bvh4", rt::guarded<topology>, rt::Traits());
constexpr rt_device_build kBuild = rt::device_topology(rt::file(kFiles, "ploc_build.cl"), rt::guarded<plan>);
constexpr rt_extension kExtensions[] = {rt::extension(kBuild), rt::kNoMoreExtensions};
static_assert(kBuild.kernels.text, "the kernel file is embedded");

}  // namespace
}  // namespace ploc

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("ploc", "BVH by locally-ordered clustering, for builds on the device", "1.0.0",
                     "Benthin, Meister, Barczak, Mehalwal, Tsakok, Kensler 2024, H-PLOC: Hierarchical Parallel Locally-Ordered "
                     "Clustering for Bounding Volume Hierarchy Construction",
                     ploc::kAccel),
    ploc::kExtensions);
