// tree.hpp -- what builders that part space write alike. Header only, part of the SDK.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "rt_plugin.hpp"

namespace clarity::space {

// The number of primitives in all groups. Fails if a structure that names them by 32 bits cannot hold so many.
inline rt_u32 primitive_count(const rt_host* host, const rt_build_input& in) {
    uint64_t count = 0;
    for (rt_u32 g = 0; g < in.group_count; ++g) count += in.groups[g].count;
    if (count > RT_REF_INDEX_MAX) throw rt::fail(host, "holds 2^28 - 1 primitives at most: instance meshes, or leave some out");
    return rt_u32(count);
}

// Writes the leaves: the primitives group by group, each once, in their own order. Cells name them by their positions.
inline void put_leaves(const rt_host* host, const rt_build_input& in, const rt_build_output* out, rt_u32 count) {
    constexpr rt_u32 kAtOnce = 65536;
    rt_u32* leaf = rt::leaves(out, count);
    for (rt_u32 g = 0; g < in.group_count; leaf += in.groups[g].count, ++g) {
        const rt_group& group = in.groups[g];
        const auto put = [&](rt_u32 part) {
            for (rt_u32 i = part * kAtOnce, end = std::min(group.count, i + kAtOnce); i < end; ++i)
                leaf[i] = in.prims[group.first + i].ref;
        };
        if (group.count > kAtOnce)
            rt::parallel_for(host, (group.count - 1) / kAtOnce + 1, put);
        else
            put(0);
    }
}

// A node of a tree, and the cell that is its part of space.
template <class Cell>
struct Visit {
    rt_u32 node, level;
    Cell cell;
};

// A box, which has lo[3] and hi[3], from six numbers: its lower corner first.
template <class Box>
Box box_of(const float* numbers) {
    Box box;
    std::copy_n(numbers, 3, box.lo);
    std::copy_n(numbers + 3, 3, box.hi);
    return box;
}

// Gives the sink the boxes around the cells of a level, or of the leaves. all: the cell of the root. is_leaf(node) tells leaves
// from others; is_shown(visit) whether there is something in a cell; part(visit, stack) appends a node's children;
// box_of_cell(cell) returns its box.
template <class Cell, class IsLeaf, class IsShown, class Part, class BoxOfCell>
void show_level(rt_u32 root, const Cell& all, rt_u32 level, const rt_volume_sink* sink, const IsLeaf& is_leaf,
                const IsShown& is_shown, const Part& part, const BoxOfCell& box_of_cell) {
    std::vector<Visit<Cell>> stack{{root, 0, all}};
    while (!stack.empty()) {
        const Visit<Cell> at = std::move(stack.back());
        stack.pop_back();
        const bool leaf = is_leaf(at.node);
        if (level == RT_LEVEL_BOTTOM ? leaf : at.level == level) {
            if (!is_shown(at)) continue;
            const auto& box = box_of_cell(at.cell);
            sink->box(sink->ctx, box.lo, box.hi);
        } else if (!leaf) {
            part(at, stack);
        }
    }
}
// The same of cells that are boxes.
template <class Cell, class IsLeaf, class IsShown, class Part>
void show_level(rt_u32 root, const Cell& all, rt_u32 level, const rt_volume_sink* sink, const IsLeaf& is_leaf,
                const IsShown& is_shown, const Part& part) {
    show_level(root, all, level, sink, is_leaf, is_shown, part, [](const Cell& cell) -> const Cell& { return cell; });
}

}  // namespace clarity::space
