#include "refit.hpp"

#include "clarity_bvh/refit/refit.hpp"
#include "volumes.hpp"

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

// The primitives at positions from first to end in leaf order, as they are now.
class LeafTriangles final : public Triangles {
 public:
    LeafTriangles(const rt_packed_prim* leaves, rt_u32 count) : leaves_(leaves), count_(count) {}
    rt_u32 count() const override { return count_; }
    const rt_packed_prim* operator[](rt_u32 i) const override { return leaves_ + i; }

 private:
    const rt_packed_prim* const leaves_;
    const rt_u32 count_;
};

// A node's volume is that of its primitives or of their box, as in a build, so it does not grow from level to level. Oriented
// boxes keep their axes. Only nodes of nothing but triangles have such, and their positions stand together.
class SpheresRefit {
 public:
    static constexpr uint32_t kWidth = 2, kBlock = 256;

    SpheresRefit(spheres_node* nodes, const Volumes& volumes, const rt_refit_input* in)
        : nodes_(nodes), volumes_(volumes), in_(in) {}

    RefitUnit unit(uint32_t group) const {
        const float size = volumes_.size(in_->roots[group]);
        return RefitUnit(size > 0 ? 1 / size : 1);
    }
    template <class Each>
    void subtrees(uint32_t group, Each&& each) const {
        const uint32_t head = in_->roots[group];
        for (uint32_t at = head + 1; at < nodes_[head].link; at = end_of(at)) each(RefitSubtree{at, at + 1, end_of(at)});
    }
    uint32_t children(const RefitSubtree& tree, RefitSubtree out[kWidth]) const {
        if (nodes_[tree.node].count > 0) return 0;
        const uint32_t second = end_of(tree.first);
        out[0] = {tree.first, tree.first + 1, second};
        out[1] = {second, second + 1, tree.end};
        return 2;
    }
    uint64_t add_positions(uint32_t at, uint64_t& first, uint64_t& end) const {
        const spheres_node& node = nodes_[at];
        if (node.count == 0) return 0;
        first = std::min<uint64_t>(first, node.link);
        end = std::max<uint64_t>(end, uint64_t{node.link} + node.count);
        return node.count;
    }
    template <class NodeBox, class LeafBox>
    RefitBox update(uint32_t at, NodeBox&& node_box, LeafBox&& leaf_box, const RefitUnit& unit, RefitAreas& areas) const {
        const spheres_node& node = nodes_[at];
        RefitBox box;
        if (node.count > 0) {
            box = leaf_box(node.link, node.count);
        } else {
            box = node_box(at + 1);
            box.add(node_box(end_of(at + 1)));
        }
        if (!volumes_.is_everywhere(at)) put(at, box_of(box));
        const Vec4 area = unit.area(box);
        if (node.count > 0)
            areas.primitives = areas.primitives + area * splat(static_cast<float>(node.count));
        else
            areas.nodes = areas.nodes + area;
        return box;
    }
    void finish(uint32_t group, const RefitBox& box) const {
        const uint32_t head = in_->roots[group];
        if (nodes_[head].link > head + 1) volumes_.enclose(head, box_of(box));
    }

 private:
    uint32_t end_of(uint32_t at) const { return nodes_[at].count > 0 ? at + 1 : nodes_[at].link; }
    void put(uint32_t at, const Box& box) const {
        uint32_t first = at;
        while (nodes_[first].count == 0) ++first;
        const spheres_node& last = nodes_[end_of(at) - 1];
        const uint32_t begin = nodes_[first].link, end = last.link + last.count;
        volumes_.refit(at, box, LeafTriangles(in_->leaves + begin, end - begin));
    }

    spheres_node* const nodes_;
    const Volumes& volumes_;
    const rt_refit_input* const in_;
};

}  // namespace

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    auto* const nodes = static_cast<spheres_node*>(out->slots[0]);
    const Volumes volumes(*static_cast<const rt_u32*>(out->slots[2]), nodes, static_cast<spheres_axes*>(out->slots[1]));
    SpheresRefit layout(nodes, volumes, in);
    Refit<SpheresRefit>(host, in, out, layout, {1, 1}).run();
    return RT_OK;
}

}  // namespace spheres
