// builder_spatial.cpp -- the steps of the builder for spatial splits.
#include <algorithm>

#include "clarity_bvh/build/builder.hpp"

namespace clarity::bvh {

// Splits the ranges level by level, each range on all cores, until each is a task for one thread. At the end, close_gaps()
// makes the refs contiguous.
void TopologyBuilder::split_space(std::vector<Pending> level, const RefMemory& refs) {
    const Scratch<rt_u32> leaves(room_);
    workspace_.leaves = leaves.data();
    std::vector<SpatialSplitter> splitters;  // of groups
    for (const Root& root : tree_.roots) splitters.emplace_back(host_, workspace_, *input_.geometry, root.box);
    while (!level.empty()) {
        const std::vector<Pending> large = part_tasks(level);
        std::vector<RoomyRange> parts(2 * large.size());
        parallel_for(large.size(), [&](uint32_t i) {
            const Pending& from = large[i];
            splitters[from.group].split({from.range, from.room_begin, from.room_end}, parts[2 * i], parts[2 * i + 1]);
        });
        level.clear();
        for (uint32_t i = 0; i < large.size(); ++i) {
            RoomyRange &left = parts[2 * i], &right = parts[2 * i + 1];
            const rt_u32 node = left.room_end - 1, group = large[i].group;  // see Workspace::nodes
            if (right_is_larger(AreaScale(large[i].range.box), left.range, right.range)) std::swap(left, right);
            put(large[i], node);
            tree_.tops.push_back({node, scales_[group]});
            set_child(tree_nodes_[node], 0, left.range.box, 0);
            set_child(tree_nodes_[node], 1, right.range.box, 0);
            level.push_back({left.range, node, 0, group, left.room_begin, left.room_end});
            level.push_back({right.range, node, 1, group, right.room_begin, right.room_end});
        }
        report(0);
    }
    std::vector<uint32_t> counts(tasks_.size());
    run_tasks([&](uint32_t t) {
        const Pending& task = tasks_[t];
        set_part(t, splitters[task.group].build({task.range, task.room_begin, task.room_end}, counts[t]));
    });
    close_gaps(counts, refs);
}

// Copies the refs of all tasks into the leaf order without gaps between tasks, and corrects the positions in the leaf codes.
void TopologyBuilder::close_gaps(const std::vector<uint32_t>& counts, const RefMemory& refs) {
    std::vector<uint32_t> order(counts.size()), place(counts.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return tree_.parts[a].first_node < tree_.parts[b].first_node; });
    tree_.ref_count = 0;
    for (const uint32_t t : order) {
        place[t] = static_cast<uint32_t>(tree_.ref_count);
        tree_.ref_count += counts[t];
    }
    rt_u32* const leaves = refs(tree_.ref_count);
    parallel_for(counts.size(), [&](uint32_t t) {
        Part& part = tree_.parts[t];
        const uint32_t first = part.first_node, back = first - place[t];
        std::copy_n(workspace_.leaves + first, counts[t], leaves + place[t]);
        const auto move = [&](uint32_t code) { return is_leaf(code) ? code - back : code; };
        for (uint32_t i = first; i < first + part.node_count; ++i) {
            tree_nodes_[i].child0 = move(tree_nodes_[i].child0);
            tree_nodes_[i].child1 = move(tree_nodes_[i].child1);
        }
        part.root = move(part.root);
        put(tasks_[t], part.root);
    });
}

}  // namespace clarity::bvh
