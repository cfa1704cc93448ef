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

}  // namespace

int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out) {
    uint64_t primitives = 0, nodes = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        primitives += input->groups[g].count;
        nodes += input->groups[g].count ? 2 * uint64_t{input->groups[g].count} - 1 : 0;
    }
    if (primitives > RT_REF_INDEX_MAX) return host->fail(host->ctx, "ploc takes at most 268435455 primitives");
    rt_topology_node* const all = rt::nodes(out, nodes);
    rt_u32* const refs = rt::refs(out, primitives);
    std::vector<ploc_place> places;
    rt_u32 base = 0, first_ref = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        const rt_group group = input->groups[g];
        if (group.count == 0) {
            rt::root(out, g, RT_NONE);
            continue;
        }
        if (!host->progress(host->ctx, float(first_ref) / float(primitives))) return RT_CANCELLED;
        const rt_prim* const prims = input->prims + group.first;
        const std::vector<CurveKey> keys = clarity::bvh::order_along_curve(host, prims, group.count);
        places.resize(group.count);
        const rt_u32 leaves = base + group.count - 1;
        const rt_u32 root =
            group.count > 1 ? base + cluster_group(host, {prims, keys.data(), all + base, places.data()}, group.count) : leaves;
        const auto child = [&](rt_u32 code) { return code & PLOC_SINGLE ? leaves + (code & ~PLOC_SINGLE) : base + code; };
        for (rt_u32 i = 0; i + 1 < group.count; ++i) {
            rt_topology_node& node = all[base + i];
            node.left = child(node.left);
            node.right = child(node.right);
        }
        for (rt_u32 i = 0; i < group.count; ++i) {
            const rt_prim& prim = prims[keys[i].number];
            refs[first_ref + i] = prim.ref;
            rt_topology_node& leaf = all[leaves + i];
            std::copy_n(prim.lo, 3, leaf.lo);
            std::copy_n(prim.hi, 3, leaf.hi);
            leaf.left = first_ref + i;
            leaf.right = RT_TOPOLOGY_LEAF | 1u;
        }
        rt::root(out, g, root);
        base += 2 * group.count - 1;
        first_ref += group.count;
    }
    return RT_OK;
}

}  // namespace ploc
