#include "host_build.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

#include "clarity_bvh/build/morton_order.hpp"
#include "limits.hpp"
#include "rt_plugin.hpp"

#define PLOC_INLINE inline
#define PLOC_HIGHEST_BIT(x) (63u - static_cast<rt_u32>(__builtin_clzll(x)))

namespace ploc {
namespace {

using clarity::bvh::CurveKey;
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

rt_u32 write_inner(const rt_host* host, const clarity::bvh::CurveGroup& group) {
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

}  // namespace

int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out) {
    return clarity::bvh::build_along_curve(host, input, out, "ploc",
                                           [&](const clarity::bvh::CurveGroup& group) { return write_inner(host, group); });
}

}  // namespace ploc
