#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {
namespace {

double area(const float box[6]) {
    const double x = double{box[3]} - box[0], y = double{box[4]} - box[1], z = double{box[5]} - box[2];
    return 2 * (x * y + y * z + z * x);
}

}  // namespace

uint64_t Topology::node_count() const {
    uint64_t count = tops.size();
    for (const Part& part : parts) count += part.node_count;
    return count;
}

Quality measure(const Topology& topology, const rt_group* groups, float traversal_cost, float intersection_cost) {
    Quality result;
    double cost = 0, primitives = 0;
    std::vector<uint32_t> stack;
    for (size_t g = 0; g < topology.roots.size(); ++g) {
        const Root& root = topology.roots[g];
        if (root.code == RT_NONE) continue;
        const float box[6] = {root.box.lo[0], root.box.lo[1], root.box.lo[2], root.box.hi(0), root.box.hi(1), root.box.hi(2)};
        const double whole = area(box);
        double node_area = 0, primitive_area = 0;
        const auto look = [&](const float* child_box, uint32_t child) {
            if (is_leaf(child)) {
                ++result.leaves;
                primitive_area += area(child_box) * leaf_count(child);
            } else {
                node_area += area(child_box);
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
        if (!(whole > 0)) continue;  // no ray hits a point or a line
        cost += groups[g].count * (double{traversal_cost} * node_area + double{intersection_cost} * primitive_area) / whole;
        primitives += groups[g].count;
    }
    result.sah_cost = primitives > 0 ? cost / primitives : 0;
    return result;
}

}  // namespace clarity::bvh
