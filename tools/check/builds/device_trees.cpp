#include "tools/check/builds/device_trees.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::check {
namespace {

struct Box {
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    template <class Other>
    void add(const Other& other) {
        for (int k = 0; k < 3; ++k) {
            lo[k] = std::min(lo[k], other.lo[k]);
            hi[k] = std::max(hi[k], other.hi[k]);
        }
    }
};

std::string node_name(rt_u32 node) {
    return "node " + std::to_string(node);
}

// Writes node `at` over the places first .. end - 1, whose left child has those before `split`.
void write_node(DeviceTree& tree, const std::vector<rt_prim>& prims, rt_u32 at, rt_u32 left, rt_u32 right, rt_u32 first,
                rt_u32 end) {
    Box box;
    for (rt_u32 place = first; place < end; ++place) box.add(prims[tree.order[place]]);
    rt_topology_node& node = tree.nodes[at];
    std::copy_n(box.lo, 3, node.lo);
    std::copy_n(box.hi, 3, node.hi);
    node.left = left;
    node.right = right;
    tree.counts[at] = end - first;
}

// A node has the number of its split, less one. Returns the code of the child.
rt_u32 halve(DeviceTree& tree, const std::vector<rt_prim>& prims, rt_u32 first, rt_u32 end, rt_u32 level) {
    if (end - first == 1) return RT_TOPOLOGY_LEAF | first;
    tree.depth = std::max(tree.depth, level);
    const rt_u32 split = first + (end - first) / 2, at = split - 1;
    const rt_u32 left = halve(tree, prims, first, split, level + 1), right = halve(tree, prims, split, end, level + 1);
    write_node(tree, prims, at, left, right, first, end);
    return at;
}

DeviceTree ordered(const std::vector<rt_prim>& prims) {
    DeviceTree tree;
    for (rt_u32 i = 0; i < prims.size(); ++i) tree.order.push_back(i);
    const auto middle = [&](rt_u32 i) { return 0.5f * prims[i].lo[0] + 0.5f * prims[i].hi[0]; };
    std::stable_sort(tree.order.begin(), tree.order.end(), [&](rt_u32 a, rt_u32 b) { return middle(a) < middle(b); });
    tree.nodes.resize(prims.size() > 1 ? prims.size() - 1 : 0);
    tree.counts.resize(tree.nodes.size());
    return tree;
}

}  // namespace

DeviceTree halved_tree(const std::vector<rt_prim>& prims) {
    DeviceTree tree = ordered(prims);
    if (!tree.nodes.empty()) tree.root = halve(tree, prims, 0, static_cast<rt_u32>(prims.size()), 1);
    return tree;
}

DeviceTree chain_tree(const std::vector<rt_prim>& prims) {
    DeviceTree tree = ordered(prims);
    const auto count = static_cast<rt_u32>(prims.size());
    for (rt_u32 i = 0; i < tree.nodes.size(); ++i)
        write_node(tree, prims, i, RT_TOPOLOGY_LEAF | i, i + 2 == count ? RT_TOPOLOGY_LEAF | (i + 1) : i + 1, i, count);
    tree.depth = static_cast<rt_u32>(tree.nodes.size());
    return tree;
}

Problem order_fault(const std::vector<rt_u32>& order) {
    std::vector<bool> seen(order.size());
    for (size_t i = 0; i < order.size(); ++i) {
        const std::string place = " at place " + std::to_string(i);
        if (order[i] >= order.size())
            return "names primitive " + std::to_string(order[i]) + place + ", but there are " + std::to_string(order.size());
        if (seen[order[i]]) return "names primitive " + std::to_string(order[i]) + " twice, again" + place;
        seen[order[i]] = true;
    }
    return {};
}

Problem tree_fault(const DeviceTree& tree, const std::vector<rt_prim>& prims, std::vector<rt_u32>& leaves) {
    leaves.clear();
    if (tree.depth > RT_TOPOLOGY_DEPTH)
        return "reported a depth of " + std::to_string(tree.depth) + ", at most " + std::to_string(RT_TOPOLOGY_DEPTH) +
               " are possible";
    if (const Problem why = order_fault(tree.order)) return why;
    if (tree.nodes.empty()) {
        leaves = tree.order;
        return {};
    }
    const size_t node_count = tree.nodes.size();
    std::vector<bool> seen(node_count), placed(prims.size());
    struct Visit {
        rt_u32 code, level;
    };
    std::vector<rt_u32> parents_first;
    std::vector<Visit> stack = {{tree.root, 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        if (at.code & RT_TOPOLOGY_LEAF) {
            const rt_u32 place = at.code & ~RT_TOPOLOGY_LEAF;
            if (place >= prims.size())
                return "made a leaf of place " + std::to_string(place) + ", but there are " + std::to_string(prims.size()) +
                       " primitives";
            if (placed[place]) return "made two leaves of place " + std::to_string(place);
            placed[place] = true;
            leaves.push_back(tree.order[place]);
            continue;
        }
        if (at.code >= node_count)
            return "named " + node_name(at.code) + ", but " + std::to_string(prims.size()) + " primitives have " +
                   std::to_string(node_count) + " nodes";
        if (seen[at.code]) return "gave " + node_name(at.code) + " two parents, or a circle leads through it";
        seen[at.code] = true;
        if (at.level > tree.depth)
            return "reported a depth of " + std::to_string(tree.depth) + ", but " + node_name(at.code) + " has " +
                   std::to_string(at.level - 1) + " nodes above it: the traversal's stack would be too small";
        parents_first.push_back(at.code);
        stack.push_back({tree.nodes[at.code].right, at.level + 1});
        stack.push_back({tree.nodes[at.code].left, at.level + 1});
    }
    if (leaves.size() < prims.size())
        return "lost primitives: " + std::to_string(leaves.size()) + " of " + std::to_string(prims.size()) + " are in the tree";
    std::vector<Box> boxes(node_count);
    std::vector<rt_u32> below(node_count, 0);
    for (size_t i = parents_first.size(); i-- > 0;) {
        const rt_u32 at = parents_first[i];
        const rt_topology_node& node = tree.nodes[at];
        for (const rt_u32 child : {node.left, node.right}) {
            if (child & RT_TOPOLOGY_LEAF) {
                boxes[at].add(prims[tree.order[child & ~RT_TOPOLOGY_LEAF]]);
                ++below[at];
            } else {
                boxes[at].add(boxes[child]);
                below[at] += below[child];
            }
        }
        if (tree.counts[at] != below[at])
            return "counted " + std::to_string(tree.counts[at]) + " primitives below " + node_name(at) + ", which has " +
                   std::to_string(below[at]);
        for (int k = 0; k < 3; ++k)
            if (!(node.lo[k] <= boxes[at].lo[k] && node.hi[k] >= boxes[at].hi[k]))
                return "gave " + node_name(at) + ", of " + std::to_string(below[at]) +
                       " primitives, a box that does not hold them: in " + "xyz"[k] + " it reaches from " +
                       std::to_string(node.lo[k]) + " to " + std::to_string(node.hi[k]) + ", they reach from " +
                       std::to_string(boxes[at].lo[k]) + " to " + std::to_string(boxes[at].hi[k]);
    }
    return {};
}

}  // namespace clarity::check
