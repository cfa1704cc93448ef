// refit_poses.hpp -- goes from pose to pose, and asks your Follower what is to be done. It is not handed in.
#pragma once
#include "lab_tree.hpp"

namespace refit {

// Group 0 is the world. Behind it come the poses, in the order of time; other scenes have meshes there, of any kinds.
template <class Follower>
int32_t follow_poses(const rt_build_input* in, const rt_topology_output* out) {
    std::vector<lab::Tree> trees;
    Follower follower;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_prim* const prims = in->prims + in->groups[g].first;
        const rt_u32 count = in->groups[g].count;
        const bool moved = g > 1 && count > 0 && count == in->groups[g - 1].count;
        lab::Tree tree = moved ? trees.back() : lab::Tree();
        // A primitive is number i of its group in each pose, and its ref is the group's first ref + i.
        for (rt_u32& ref : tree.order) ref = ref - in->prims[in->groups[g - 1].first].ref + prims[0].ref;
        if (!moved || !follower.follow(tree, prims)) {
            tree = lab::make_tree(prims, count, lab::split_at_median);
            follower.built(tree, count);
        }
        trees.push_back(std::move(tree));
    }
    lab::put_trees(out, trees);
    return RT_OK;
}

}  // namespace refit
