#include "wide_levels.hpp"

#include <vector>

#include "node_bounds.hpp"
#include "node_memory.hpp"
#include "rt_plugin.hpp"

namespace bvh8 {

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* nodes = static_cast<const bvh8_node*>(built->slots[0]);
    const auto show = [&](const float box[6]) { sink->box(sink->ctx, box, box + 3); };
    if (level == 0) {
        float box[6];
        if (bounds(settled_node(nodes, built->roots[group]), box)) show(box);
        return RT_OK;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{built->roots[group], 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        each_child(settled_node(nodes, at.node), [&](const float box[6], rt_u32 child) {
            const bool leaf = (child & BVH8_LEAF) != 0;
            if (level == RT_LEVEL_BOTTOM ? leaf : at.level == level)
                show(box);
            else if (!leaf)
                stack.push_back({child, at.level + 1});
        });
    }
    return RT_OK;
}

}  // namespace bvh8
