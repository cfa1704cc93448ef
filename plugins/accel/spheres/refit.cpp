#include "refit.hpp"

#include "clarity_bvh/refit/refit.hpp"
#include "sphere_tree.hpp"

namespace spheres {
namespace {

using namespace clarity::bvh;

Box box_of(const RefitBox& from) {
    Box box;
    alignas(16) float lo[4], hi[4];
    store(lo, from.lo);
    store(hi, from.hi);
    for (int k = 0; k < 3; ++k) {
        box.lo[k] = lo[k];
        box.hi[k] = hi[k];
    }
    return box;
}

// A node's sphere is that of the box around its primitives, as in a build, so it does not grow from level to level.
class SpheresRefit {
 public:
    static constexpr uint32_t kWidth = 2, kBlock = 256;

    SpheresRefit(spheres_node* nodes, const rt_refit_input* in) : nodes_(nodes), in_(in) {}

    RefitUnit unit(uint32_t group) const {
        const float radius = nodes_[in_->roots[group]].radius;
        return RefitUnit(radius > 0 ? 1 / radius : 1);
    }
    template <class Each>
    void subtrees(uint32_t group, Each&& each) const {
        const uint32_t head = in_->roots[group];
        for (uint32_t at = head + 1; at < nodes_[head].skip; at = nodes_[at].skip)
            each(RefitSubtree{at, at + 1, nodes_[at].skip});
    }
    uint32_t children(const RefitSubtree& tree, RefitSubtree out[kWidth]) const {
        if (nodes_[tree.node].count > 0) return 0;
        const uint32_t second = nodes_[tree.first].skip;
        out[0] = {tree.first, tree.first + 1, second};
        out[1] = {second, second + 1, tree.end};
        return 2;
    }
    uint64_t add_positions(uint32_t at, uint64_t& first, uint64_t& end) const {
        const spheres_node& node = nodes_[at];
        if (node.count == 0) return 0;
        first = std::min<uint64_t>(first, node.first);
        end = std::max<uint64_t>(end, uint64_t{node.first} + node.count);
        return node.count;
    }
    template <class NodeBox, class LeafBox>
    RefitBox update(uint32_t at, NodeBox&& node_box, LeafBox&& leaf_box, const RefitUnit& unit, RefitAreas& areas) const {
        spheres_node& node = nodes_[at];
        RefitBox box;
        if (node.count > 0) {
            box = leaf_box(node.first, node.count);
        } else {
            box = node_box(at + 1);
            box.add(node_box(nodes_[at + 1].skip));
        }
        if (node.radius < kEverywhere) set_sphere(node, box_of(box));
        const Vec4 area = unit.area(box);
        if (node.count > 0)
            areas.primitives = areas.primitives + area * splat(static_cast<float>(node.count));
        else
            areas.nodes = areas.nodes + area;
        return box;
    }
    void finish(uint32_t group, const RefitBox& box) const {
        spheres_node& head = nodes_[in_->roots[group]];
        if (head.skip > in_->roots[group] + 1) set_sphere(head, box_of(box));
    }

 private:
    spheres_node* const nodes_;
    const rt_refit_input* const in_;
};

}  // namespace

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    SpheresRefit layout(static_cast<spheres_node*>(out->slots[0]), in);
    Refit<SpheresRefit>(host, in, out, layout, {1, 1}).run();
    return RT_OK;
}

}  // namespace spheres
