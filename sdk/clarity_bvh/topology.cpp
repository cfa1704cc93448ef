#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

uint64_t Topology::node_count() const {
    uint64_t count = tops.size();
    for (const Part& part : parts) count += part.node_count;
    return count;
}

Quality measure(const Topology& topology, const rt_group* groups, float traversal_cost, float intersection_cost) {
    Quality result;
    std::vector<uint32_t> stack;
    for (size_t g = 0; g < topology.roots.size(); ++g) {
        const Root& root = topology.roots[g];
        if (root.code == RT_NONE) continue;
        const float box[6] = {root.box.lo[0], root.box.lo[1], root.box.lo[2], root.box.hi(0), root.box.hi(1), root.box.hi(2)};
        rt::Surfaces sums;
        const auto look = [&](const float* child_box, uint32_t child) {
            if (is_leaf(child)) {
                ++result.leaves;
                sums.add_leaf(rt::surface_of(child_box), leaf_count(child));
            } else {
                sums.add_node(rt::surface_of(child_box));
                stack.push_back(child);
            }
        };
        look(box, root.code);
        while (!stack.empty()) {
            const Node& node = topology.nodes.data()[stack.back()];
            stack.pop_back();
            look(node.box0, node.child0);
            look(node.box1, node.child1);
        }
        result.expected.add_group(groups[g].count, rt::surface_of(box), sums);
    }
    result.sah_cost = result.expected.weighted(traversal_cost, intersection_cost);
    return result;
}

}  // namespace clarity::bvh
