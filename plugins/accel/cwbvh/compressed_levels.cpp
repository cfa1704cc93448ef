#include "compressed_levels.hpp"

#include <algorithm>
#include <cfloat>
#include <vector>

#include "quantize.hpp"
#include "rt_plugin.hpp"

namespace cwbvh {
namespace {

struct Box {
    float lo[3], hi[3];
};

Box rounded(const cwbvh_node& node, rt_u32 slot) {
    double lo[3], hi[3];
    box_of(node, slot, lo, hi);
    Box box;
    for (int a = 0; a < 3; ++a) {
        box.lo[a] = static_cast<float>(std::clamp<double>(lo[a], -FLT_MAX, FLT_MAX));
        box.hi[a] = static_cast<float>(std::clamp<double>(hi[a], -FLT_MAX, FLT_MAX));
    }
    return box;
}

// Calls do_one(box, child) for every child of a node. `child` is RT_NONE for a leaf.
template <class Body>
void each_child(const cwbvh_node& node, Body&& do_one) {
    rt_u32 next = node.first_child;
    for (rt_u32 slot = 0; slot < 8; ++slot) {
        if (CWBVH_INNER(&node) >> slot & 1u)
            do_one(rounded(node, slot), next++);
        else if (node.primitives >> 4 * slot & 15u)
            do_one(rounded(node, slot), RT_NONE);
    }
}

}  // namespace

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* nodes = static_cast<const cwbvh_node*>(built->slots[0]);
    const auto show = [&](const Box& box) { sink->box(sink->ctx, box.lo, box.hi); };
    if (level == 0) {
        Box whole;
        std::fill_n(whole.lo, 3, FLT_MAX);
        std::fill_n(whole.hi, 3, -FLT_MAX);
        each_child(nodes[built->roots[group]], [&](const Box& box, rt_u32) {
            for (int a = 0; a < 3; ++a) {
                whole.lo[a] = std::min(whole.lo[a], box.lo[a]);
                whole.hi[a] = std::max(whole.hi[a], box.hi[a]);
            }
        });
        if (whole.lo[0] <= whole.hi[0]) show(whole);
        return RT_OK;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{built->roots[group], 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        each_child(nodes[at.node], [&](const Box& box, rt_u32 child) {
            if (level == RT_LEVEL_BOTTOM ? child == RT_NONE : at.level == level)
                show(box);
            else if (child != RT_NONE)
                stack.push_back({child, at.level + 1});
        });
    }
    return RT_OK;
}

}  // namespace cwbvh
