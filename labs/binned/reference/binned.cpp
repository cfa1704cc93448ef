// binned.cpp -- our solution of the lab: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies", with 16
// bins for each axis.
#include "lab_tree.hpp"

namespace {

constexpr int kBins = 16;
constexpr float kNodeCost = 1.2f;  // of a node to a ray, in tests of a primitive

struct Bin {
    lab::Box box;
    float count = 0;
    void add(const Bin& other) { box.add(other.box.lo, other.box.hi), count += other.count; }
    float cost() const { return box.surface() * count; }
};

struct Plane {
    int axis = 0, bin = 0;  // the first bin of the right child
    float cost = 3e38f;     // both children, by the surface of their parent
};

// Bins of centres from lo to hi.
struct Bins {
    float lo, scale;
    Bins(float from, float to) : lo(from), scale(float(kBins) / (to - from)) {}
    int of(float centre) const { return std::min(int((centre - lo) * scale), kBins - 1); }
};

rt_prim* split(const lab::Box& box, rt_prim* begin, rt_prim* end) {
    const auto count = end - begin;
    if (count == 1) return begin;
    Plane best;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [least, most] = std::minmax_element(
            begin, end, [axis](const rt_prim& a, const rt_prim& b) { return lab::centre(a, axis) < lab::centre(b, axis); });
        const float lo = lab::centre(*least, axis), hi = lab::centre(*most, axis);
        const Bins place(lo, hi);
        if (!(hi > lo) || !(place.scale < 1e30f)) continue;
        Bin bins[kBins], left[kBins];
        for (const rt_prim* prim = begin; prim < end; ++prim) {
            Bin& bin = bins[place.of(lab::centre(*prim, axis))];
            bin.box.add(prim->lo, prim->hi), bin.count += 1;
        }
        left[0] = bins[0];
        for (int i = 1; i < kBins; ++i) (left[i] = left[i - 1]).add(bins[i]);
        Bin right;
        for (int i = kBins - 1; i > 0; --i) {
            right.add(bins[i]);
            const float cost = (left[i - 1].cost() + right.cost()) / std::max(box.surface(), 1e-30f);
            if (left[i - 1].count > 0 && right.count > 0 && cost < best.cost) best = {axis, i, cost};
        }
    }
    if (best.cost == 3e38f) return count <= 4 ? begin : lab::split_at_median(box, begin, end);  // all centres are one point
    if (count <= 4 && float(count) <= kNodeCost + best.cost) return begin;
    float lo = 3e38f, hi = -3e38f;
    for (const rt_prim* prim = begin; prim < end; ++prim)
        lo = std::min(lo, lab::centre(*prim, best.axis)), hi = std::max(hi, lab::centre(*prim, best.axis));
    const Bins place(lo, hi);
    return std::partition(begin, end, [&](const rt_prim& prim) { return place.of(lab::centre(prim, best.axis)) < best.bin; });
}

int32_t build(const rt_host*, const rt_build_input* in, const rt_topology_output* out) {
    std::vector<lab::Tree> trees;
    for (rt_u32 g = 0; g < in->group_count; ++g)
        trees.push_back(lab::make_tree(in->prims + in->groups[g].first, in->groups[g].count, split));
    lab::put_trees(out, trees);
    return RT_OK;
}

constexpr rt_accel kAccel = rt::topology("bvh2", rt::guarded<build>, rt::Traits());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("binned", "Binned surface area heuristic", "1.0.0", nullptr, kAccel);
