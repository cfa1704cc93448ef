#include "lab/motion.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "base/error.hpp"
#include "check/builds/build_run.hpp"

namespace clarity::lab {
namespace {

// Tells sets of primitives apart, whatever their order: a sum of numbers that look random (the finalizer of Steele, Lea, Flood
// 2014, "Fast Splittable Pseudorandom Number Generators").
uint64_t mixed(uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

struct Below {
    uint64_t set = 0;
    double count = 0;
};

// The nodes of a tree, each as one number: of the primitives below it, and of how its children share them.
class TreeNodes {
 public:
    TreeNodes(const BuilderResult& result, rt_u32 root, rt_u32 first_ref)
        : nodes_(reinterpret_cast<const rt_topology_node*>(result.slots[0].memory.data())),
          refs_(reinterpret_cast<const rt_u32*>(result.refs.data())),
          first_ref_(first_ref) {
        if (root != RT_NONE) visit(root);
    }
    std::vector<std::pair<uint64_t, double>> all;  // node, primitives below it

 private:
    // Trees are at most RT_TOPOLOGY_DEPTH deep: BuildCase has checked it.
    Below visit(rt_u32 at) {
        const rt_topology_node& node = nodes_[at];
        Below below;
        uint64_t shares = 0;
        if (node.right & RT_TOPOLOGY_LEAF) {
            for (rt_u32 i = 0; i < (node.right & ~RT_TOPOLOGY_LEAF); ++i)
                below.set += mixed(RT_REF_INDEX(refs_[node.left + i]) - first_ref_), below.count += 1;
        } else {
            const Below left = visit(node.left), right = visit(node.right);
            below = {left.set + right.set, left.count + right.count};
            shares = mixed(left.set) + mixed(right.set);
        }
        all.emplace_back(mixed(below.set) ^ shares, below.count);
        return below;
    }

    const rt_topology_node* nodes_;
    const rt_u32* refs_;
    const rt_u32 first_ref_;
};

}  // namespace

MotionCosts motion_costs(const rt_plugin& plugin, const Scene& scene) {
    const check::BuildCase input("the poses", scene);
    const BuildScene& build = input.scene();
    const check::BuildRun run = input.run(plugin, {}, check::Schedule::program);
    if (run.why) throw Error(Exit::failed, run.why.text());
    MotionCosts costs;
    std::set<uint64_t> before;
    for (const rt_u32 group : build.group_of_mesh) {
        const TreeNodes tree(run.result, run.result.roots[group], build.first_ref_of_group[group]);
        std::set<uint64_t> now;
        for (const auto& [node, count] : tree.all) {
            now.insert(node);
            if (before.count(node)) continue;
            costs.fresh += 1, costs.sorted += count;
        }
        costs.nodes += double(tree.all.size());
        before = std::move(now);
    }
    return costs;
}

}  // namespace clarity::lab
