// levels.hpp -- lists the boxes of one level of a group's tree, for drawing (rt_accel::levels).
#pragma once
#include <algorithm>
#include <vector>

#include "clarity_bvh/wide/wide_node.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// Passes the boxes of `level` to the sink: 0 is the root's box, RT_LEVEL_BOTTOM is all leaves. each(node, visit) calls
// visit(box, child) for each child of a node: 6 floats, and the child's node, or RT_NONE for a leaf. Throws if the group does
// not exist.
template <class Each>
void show_level(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink,
                const Each& each) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const rt_u32 root = built->roots[group];
    const auto show = [&](const float box[6]) { sink->box(sink->ctx, box, box + 3); };
    if (level == 0) {
        float whole[6];
        bool any = false;
        each(root, [&](const float box[6], rt_u32) {
            for (int a = 0; a < 3; ++a) {
                whole[a] = any ? std::min(whole[a], box[a]) : box[a];
                whole[3 + a] = any ? std::max(whole[3 + a], box[3 + a]) : box[3 + a];
            }
            any = true;
        });
        if (any) show(whole);
        return;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{root, 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        each(at.node, [&](const float box[6], rt_u32 child) {
            if (level == RT_LEVEL_BOTTOM ? child == RT_NONE : at.level == level)
                show(box);
            else if (child != RT_NONE)
                stack.push_back({child, at.level + 1});
        });
    }
}

// Of a wide tree. read(index) returns a node as WideLayout::write wrote it.
template <class Read>
void show_wide_level(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink,
                     const Read& read) {
    show_level(host, built, group, level, sink, [&](rt_u32 node, const auto& visit) {
        each_child(read(node), [&](const float box[6], uint32_t child) { visit(box, is_leaf(child) ? RT_NONE : child); });
    });
}

}  // namespace clarity::bvh
