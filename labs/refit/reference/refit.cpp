// refit.cpp -- our solution of the lab. Boxes are fitted from the leaves up (Wald, Boulos, Shirley 2007, "Ray Tracing
// Deformable Scenes using Dynamic Bounding Volume Hierarchies"). A tree that has become worse costs its rays more in each pose;
// once that sum is as large as the cost of a build, a build follows. So we pay at most twice what the best choice would have
// cost.
#include "refit_poses.hpp"

namespace {

constexpr double kRaysOfPose = 30, kBox = 0.2, kNode = 1.2;  // page.md

struct Follower {
    double cost_built = 0, price = 0, debt = 0;

    // Expected work of a ray, by the surface area heuristic.
    static double cost(const lab::Tree& tree) {
        double sum = 0;
        for (const rt_topology_node& node : tree.nodes) {
            const bool is_leaf = node.right & RT_TOPOLOGY_LEAF;
            sum += surface(node) * (is_leaf ? double(node.right & ~RT_TOPOLOGY_LEAF) : kNode);
        }
        return sum / std::max(surface(tree.nodes.front()), 1e-30);
    }
    static double surface(const rt_topology_node& node) {
        lab::Box box;
        box.add(node.lo, node.hi);
        return box.surface();
    }

    bool follow(lab::Tree& tree, const rt_prim* prims) {
        for (size_t i = tree.nodes.size(); i-- > 0;) {
            rt_topology_node& node = tree.nodes[i];
            lab::Box box;
            if (node.right & RT_TOPOLOGY_LEAF) {
                for (rt_u32 k = 0; k < (node.right & ~RT_TOPOLOGY_LEAF); ++k) {
                    const rt_prim& prim = prims[tree.order[node.left + k] - prims[0].ref];
                    box.add(prim.lo, prim.hi);
                }
            } else {
                for (const rt_u32 child : {node.left, node.right}) box.add(tree.nodes[child].lo, tree.nodes[child].hi);
            }
            std::copy(box.lo, box.lo + 3, node.lo), std::copy(box.hi, box.hi + 3, node.hi);
        }
        debt += (cost(tree) - cost_built) * kRaysOfPose;
        return debt < price;
    }
    void built(const lab::Tree& tree, rt_u32 prims) {
        if (tree.nodes.empty()) return;
        cost_built = cost(tree), debt = price = 0;
        // Each level sorts all primitives.
        for (rt_u32 n = prims; n > 1; n /= 2) price += kBox * prims;
    }
};

int32_t build(const rt_host*, const rt_build_input* in, const rt_topology_output* out) {
    return refit::follow_poses<Follower>(in, out);
}

constexpr rt_accel kAccel = rt::topology("bvh2", rt::guarded<build>, rt::Traits());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("refit", "Refit or build", "1.0.0", nullptr, kAccel);
