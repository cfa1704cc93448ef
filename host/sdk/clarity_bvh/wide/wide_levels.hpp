// wide_levels.hpp -- lists the boxes of one level of a group's wide tree, for drawing (rt_accel::levels).
#pragma once
#include <vector>

#include "clarity_bvh/wide/wide_node.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// Passes the boxes of `level` to the sink: 0 is the root's box, RT_LEVEL_BOTTOM is all leaves. read(index) returns a node as
// WideLayout::write wrote it. Throws if the group does not exist.
template <class Read>
void show_wide_level(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink,
                     Read&& read) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto show = [&](const float box[6]) { sink->box(sink->ctx, box, box + 3); };
    if (level == 0) {
        float box[6];
        if (bounds(read(built->roots[group]), box)) show(box);
        return;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{built->roots[group], 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        each_child(read(at.node), [&](const float box[6], uint32_t child) {
            if (level == RT_LEVEL_BOTTOM ? is_leaf(child) : at.level == level)
                show(box);
            else if (!is_leaf(child))
                stack.push_back({child, at.level + 1});
        });
    }
}

}  // namespace clarity::bvh
