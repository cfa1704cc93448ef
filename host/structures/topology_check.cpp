#include "structures/topology_check.hpp"

#include <vector>

namespace clarity {
namespace {

// Walks the trees of all groups.
class Checker {
 public:
    Checker(const rt_topology& topology, const BuildScene& scene)
        : topology_(topology), scene_(scene), seen_(topology.node_count) {}

    // Returns what is wrong with the tree of a group, in terms of its builder; empty: nothing.
    Problem check(rt_u32 group) {
        const rt_u32 count = scene_.groups[group].count, root = topology_.roots[group];
        const std::string of_group = " of group " + std::to_string(group);
        if (root == RT_NONE)
            return count == 0
                       ? ""
                       : "reported no tree for group " + std::to_string(group) + ", which has " + number(count, "primitive");
        uint64_t named = 0;
        struct Visit {
            rt_u32 node, depth;
        };
        std::vector<Visit> stack = {{root, 1}};
        while (!stack.empty()) {
            const Visit at = stack.back();
            stack.pop_back();
            const auto name = [&] { return "node " + std::to_string(at.node) + of_group; };
            if (at.node >= topology_.node_count)
                return "named " + name() + ", but asked for " + number(topology_.node_count, "node");
            if (seen_[at.node]) return "gave " + name() + " two parents, or a circle leads through it";
            if (at.depth > RT_TOPOLOGY_DEPTH)
                return "made a tree" + of_group + " with more than " + std::to_string(RT_TOPOLOGY_DEPTH) +
                       " nodes above each other: split more evenly there";
            seen_[at.node] = true;
            const rt_topology_node& node = topology_.nodes[at.node];
            if (!(node.right & RT_TOPOLOGY_LEAF)) {
                stack.push_back({node.right, at.depth + 1});
                stack.push_back({node.left, at.depth + 1});
                continue;
            }
            const uint64_t size = node.right & ~RT_TOPOLOGY_LEAF;
            if (size == 0) return "made " + name() + " a leaf without refs";
            if (node.left + size > topology_.ref_count)
                return "gave leaf " + name() + " refs " + std::to_string(node.left) + " to " +
                       std::to_string(node.left + size - 1) + ", but asked for " + number(topology_.ref_count, "ref");
            for (uint64_t i = node.left; i < node.left + size; ++i)
                if (!is_known_ref(topology_.refs[i], scene_))
                    return "put a ref at place " + std::to_string(i) + " that it was not given";
            named += size;
        }
        if (named < count)
            return "lost primitives" + of_group + ": its leaves name " + number(named, "ref") + ", it was given " +
                   std::to_string(count);
        return {};
    }

 private:
    static std::string number(uint64_t count, const char* what) {
        return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
    }

    const rt_topology& topology_;
    const BuildScene& scene_;
    std::vector<bool> seen_;
};

}  // namespace

Problem topology_fault(const rt_topology& topology, const BuildScene& scene) {
    Checker checker(topology, scene);
    for (rt_u32 g = 0; g < topology.group_count; ++g)
        if (Problem why = checker.check(g)) return why;
    return {};
}

}  // namespace clarity
