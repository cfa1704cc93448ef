// ordered.cpp -- the lab's tree: splits at the median of the boxes' centres. You need not change it, and it is not handed in.
#include <algorithm>
#include <vector>

#include "rt_plugin.hpp"
// included after rt_plugin.hpp, because it uses its types:
#include "ordered_types.h"

namespace {

struct Builder {
    ordered_node* nodes;
    rt_u32* leaves;
    rt_u32 node_count = 0, leaf_count = 0, depth = 0;

    static void enclose(float* box, const rt_prim* begin, const rt_prim* end) {
        for (int axis = 0; axis < 3; ++axis) box[axis] = 3e38f, box[axis + 3] = -3e38f;
        for (const rt_prim* prim = begin; prim < end; ++prim)
            for (int axis = 0; axis < 3; ++axis) {
                box[axis] = std::min(box[axis], prim->lo[axis]);
                box[axis + 3] = std::max(box[axis + 3], prim->hi[axis]);
            }
        // A box that no ray meets.
        if (begin == end) std::fill(box, box + 6, 3e38f);
    }

    rt_u32 leaf(const rt_prim* begin, const rt_prim* end) {
        const rt_u32 first = leaf_count;
        for (const rt_prim* prim = begin; prim < end; ++prim) leaves[leaf_count++] = prim->ref;
        return ORDERED_LEAF | rt_u32(end - begin) << 28 | first;
    }

    rt_u32 child(rt_prim* begin, rt_prim* end, rt_u32 level) {
        return rt_u32(end - begin) <= ORDERED_LEAF_MAX ? leaf(begin, end) : node(begin, end, level);
    }

    // Always a node, also for few primitives: the root of a group is one.
    rt_u32 node(rt_prim* begin, rt_prim* end, rt_u32 level) {
        const rt_u32 at = node_count++;
        depth = std::max(depth, level + 1);
        float box[6];
        enclose(box, begin, end);
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (box[k + 3] - box[k] > box[axis + 3] - box[axis]) axis = k;
        rt_prim* const middle = begin + (end - begin) / 2;
        if (begin < end)
            std::nth_element(begin, middle, end, [axis](const rt_prim& a, const rt_prim& b) {
                return a.lo[axis] + a.hi[axis] < b.lo[axis] + b.hi[axis];
            });
        ordered_node made{};
        enclose(made.left_box, begin, middle);
        enclose(made.right_box, middle, end);
        made.left = child(begin, middle, level + 1);
        made.right = child(middle, end, level + 1);
        nodes[at] = made;
        return at;
    }
};

int32_t build(const rt_host*, const rt_build_input* in, const rt_build_output* out) {
    uint64_t count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) count += in->groups[g].count;
    Builder builder{rt::alloc<ordered_node>(out, 0, count + in->group_count), rt::leaves(out, count)};
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_prim* const first = in->prims + in->groups[g].first;
        std::vector<rt_prim> prims(first, first + in->groups[g].count);
        rt::root(out, g, builder.node(prims.data(), prims.data() + prims.size(), 0));
    }
    rt::define(out, "ORDERED_STACK", (builder.depth + 8) / 8 * 8);
    rt::stat(out, "nodes", builder.node_count);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "ordered.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<ordered_node>("ordered_nodes", "ordered_node")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "ordered_types.h"), rt::file(kFiles, "ordered.cl"),
                                      rt::guarded<build>, nullptr, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("ordered", "Ordered children", "1.0.0", nullptr, kAccel);
