// median.cpp -- our solution of the lab: splits at the median of the boxes' centres, across the axis on which these spread
// most.
#include <algorithm>
#include <vector>

#include "rt_plugin.hpp"

namespace {

constexpr rt_u32 kMaxLeaf = 2;

struct Builder {
    rt_topology_node* nodes;
    rt_u32* refs;
    rt_u32 node_count = 0, ref_count = 0;

    // Twice the centre of a box: only the order matters.
    static float centre(const rt_prim& prim, int axis) { return prim.lo[axis] + prim.hi[axis]; }

    static int widest_axis(const rt_prim* begin, const rt_prim* end) {
        int widest = 0;
        float most = -1;
        for (int axis = 0; axis < 3; ++axis) {
            const auto [least, greatest] = std::minmax_element(
                begin, end, [axis](const rt_prim& a, const rt_prim& b) { return centre(a, axis) < centre(b, axis); });
            const float spread = centre(*greatest, axis) - centre(*least, axis);
            if (spread > most) most = spread, widest = axis;
        }
        return widest;
    }

    rt_u32 split(rt_prim* begin, rt_prim* end) {
        const rt_u32 at = node_count++, count = rt_u32(end - begin);
        rt_topology_node node{{3e38f, 3e38f, 3e38f}, ref_count, {-3e38f, -3e38f, -3e38f}, RT_TOPOLOGY_LEAF | count};
        for (const rt_prim* prim = begin; prim < end; ++prim)
            for (int axis = 0; axis < 3; ++axis) {
                node.lo[axis] = std::min(node.lo[axis], prim->lo[axis]);
                node.hi[axis] = std::max(node.hi[axis], prim->hi[axis]);
            }
        if (count <= kMaxLeaf) {
            for (const rt_prim* prim = begin; prim < end; ++prim) refs[ref_count++] = prim->ref;
        } else {
            const int axis = widest_axis(begin, end);
            rt_prim* const middle = begin + count / 2;
            std::nth_element(begin, middle, end,
                             [axis](const rt_prim& a, const rt_prim& b) { return centre(a, axis) < centre(b, axis); });
            node.left = split(begin, middle);
            node.right = split(middle, end);
        }
        nodes[at] = node;
        return at;
    }
};

int32_t build(const rt_host*, const rt_build_input* in, const rt_topology_output* out) {
    uint64_t count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) count += in->groups[g].count;
    Builder builder{rt::nodes(out, 2 * count), rt::refs(out, count)};
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_prim* const first = in->prims + in->groups[g].first;
        std::vector<rt_prim> prims(first, first + in->groups[g].count);
        rt::root(out, g, prims.empty() ? RT_NONE : builder.split(prims.data(), prims.data() + prims.size()));
    }
    return RT_OK;
}

constexpr rt_accel kAccel = rt::topology("bvh2", rt::guarded<build>, rt::Traits());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("median", "Median splits", "1.0.0", nullptr, kAccel);
