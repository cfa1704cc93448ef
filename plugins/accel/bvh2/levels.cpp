#include "levels.hpp"

#include <algorithm>
#include <vector>

#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"

namespace bvh2 {

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* nodes = static_cast<const bvh2_node*>(built->slots[0]);
    const auto show = [&](const float box[6]) { sink->box(sink->ctx, box, box + 3); };
    const auto is_empty_child = [](rt_u32 child) { return (child & BVH2_LEAF) && BVH2_LEAF_COUNT(child) == 0; };

    const bvh2_node& root = nodes[built->roots[group]];
    if (level == 0) {
        float box[6];
        for (int i = 0; i < 3; ++i) {
            box[i] = is_empty_child(root.child1) ? root.box0[i] : std::min(root.box0[i], root.box1[i]);
            box[3 + i] = is_empty_child(root.child1) ? root.box0[3 + i] : std::max(root.box0[3 + i], root.box1[3 + i]);
        }
        if (!is_empty_child(root.child0)) show(box);
        return RT_OK;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{built->roots[group], 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        const bvh2_node& node = nodes[at.node];
        const auto visit = [&](const float box[6], rt_u32 child) {
            if (is_empty_child(child)) return;
            const bool leaf = (child & BVH2_LEAF) != 0;
            if (level == RT_LEVEL_BOTTOM ? leaf : at.level == level)
                show(box);
            else if (!leaf)
                stack.push_back({child, at.level + 1});
        };
        visit(node.box0, node.child0);
        visit(node.box1, node.child1);
    }
    return RT_OK;
}

}  // namespace bvh2
