// builder_spatial.cpp -- the steps of the builder for spatial splits.
#include <algorithm>

#include "builder.hpp"

namespace bvh2 {

// Splits the ranges level by level, each range on all cores, until each is a task for one thread. At the end, close_gaps()
// makes the refs contiguous.
void Builder::split_space(std::vector<Pending> level, const rt_build_output* out) {
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
            set_child(nodes_.data()[node], 0, left.range.box, 0);
            set_child(nodes_.data()[node], 1, right.range.box, 0);
            level.push_back({left.range, node, 0, group, left.room_begin, left.room_end});
            level.push_back({right.range, node, 1, group, right.room_begin, right.room_end});
        }
        report(0);
    }
    std::vector<uint32_t> counts(tree_.tasks.size());
    run_tasks([&](uint32_t t) {
        const Pending& place = task_place_[t];
        tree_.tasks[t].tree = splitters[place.group].build({tree_.tasks[t].range, place.room_begin, place.room_end}, counts[t]);
    });
    close_gaps(counts, out);
}

// Copies the refs of all tasks into the leaf order without gaps between tasks, and corrects the positions in the leaf codes.
void Builder::close_gaps(const std::vector<uint32_t>& counts, const rt_build_output* out) {
    std::vector<uint32_t> order(counts.size()), place(counts.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return tree_.tasks[a].first_node < tree_.tasks[b].first_node; });
    tree_.leaf_count = 0;
    for (const uint32_t t : order) {
        place[t] = static_cast<uint32_t>(tree_.leaf_count);
        tree_.leaf_count += counts[t];
    }
    rt_u32* const leaves = rt::leaves(out, tree_.leaf_count);
    parallel_for(counts.size(), [&](uint32_t t) {
        Task& task = tree_.tasks[t];
        const uint32_t first = task.first_node, back = first - place[t];
        std::copy_n(workspace_.leaves + first, counts[t], leaves + place[t]);
        const auto move = [&](rt_u32 code) { return code & BVH2_LEAF ? code - back : code; };
        for (uint32_t i = first; i < first + task.tree.nodes; ++i) {
            nodes_.data()[i].child0 = move(nodes_.data()[i].child0);
            nodes_.data()[i].child1 = move(nodes_.data()[i].child1);
        }
        task.tree.root = move(task.tree.root);
        put(task_place_[t], task.tree.root);
    });
}

}  // namespace bvh2
