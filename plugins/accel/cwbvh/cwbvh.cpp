// cwbvh.cpp -- the plugin of the compressed BVH with eight children a node, for scenes that fill a GPU's memory.
//
// It is an 8-wide tree with each box rounded outwards to a grid of 255 steps a node. A node takes 80 bytes; in bvh8 it takes
// 224. A triangle takes 55 bytes, its own record included; with bvh4 it takes 67.
#include <algorithm>
#include <array>
#include <cfloat>
#include <iterator>
#include <vector>

#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
#include "clarity_bvh/refit/refit.hpp"
#include "pack.hpp"
#include "quantize.hpp"
#include "rt_device.h"
#include "rt_device.hpp"
#include "rt_plugin.h"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "cwbvh_types.h"

namespace cwbvh {
namespace {

using namespace clarity::bvh;

// The extension `refit` of cwbvh: new volumes for primitives that moved, in the same tree.

// Number of bits. Without an instruction for it, as in the base set of x86-64, __builtin_popcount() would be a function's call.
uint32_t bits_of(uint32_t mask) {
    mask -= mask >> 1 & 0x55555555u;
    mask = (mask & 0x33333333u) + (mask >> 2 & 0x33333333u);
    return ((mask + (mask >> 4)) & 0x0F0F0F0Fu) * 0x01010101u >> 24;
}
// The same of a slot's primitives, which are set from the lowest bit on.
uint32_t primitives_of(uint32_t nibble) {
    constexpr uint8_t kCounts[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
    return kCounts[nibble];
}

// The descendants of a node stand together: first its children, then the descendants of each (pack.cpp).
class CompressedRefit {
 public:
    static constexpr uint32_t kWidth = 8, kBlock = 64;

    CompressedRefit(cwbvh_node* nodes, const rt_refit_input* in) : nodes_(nodes), ends_(in, in->slot_counts[0]), in_(in) {}

    RefitUnit unit(uint32_t group) const {
        const cwbvh_node& root = nodes_[in_->roots[group]];
        Bounds box;
        bool any = false;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            if (!(CWBVH_INNER(&root) >> slot & 1u) && !(root.primitives >> 4 * slot & 15u)) continue;
            double lo[3], hi[3];
            box_of(root, slot, lo, hi);
            float bounds[6];
            for (int a = 0; a < 3; ++a) {
                bounds[a] = static_cast<float>(std::max(lo[a], -double{FLT_MAX}));
                bounds[3 + a] = static_cast<float>(std::min(hi[a], double{FLT_MAX}));
            }
            box.add(bounds, bounds + 3);
            any = true;
        }
        return RefitUnit(any ? unit_scale(box) : 1);
    }
    template <class Each>
    void subtrees(uint32_t group, Each&& each) const {
        const uint32_t root = in_->roots[group];
        each(RefitSubtree{root, nodes_[root].first_child, ends_.end_of(root)});
    }
    // The descendants of the children follow each other in the order in which the tree was built, not in that of the slots.
    uint32_t children(const RefitSubtree& tree, RefitSubtree out[kWidth]) const {
        const cwbvh_node& node = nodes_[tree.node];
        const uint32_t count = bits_of(CWBVH_INNER(&node));
        // A node without child nodes begins where the next one does, and comes before it.
        const auto rank = [&](uint32_t child) {
            return uint64_t{nodes_[child].first_child} << 1 | (CWBVH_INNER(&nodes_[child]) != 0);
        };
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t child = node.first_child + i;
            uint32_t at = i;
            for (; at > 0 && rank(out[at - 1].node) > rank(child); --at) out[at] = out[at - 1];
            out[at] = {child, nodes_[child].first_child, 0};
        }
        for (uint32_t i = 0; i < count; ++i) out[i].end = i + 1 < count ? out[i + 1].first : tree.end;
        return count;
    }
    uint64_t add_positions(uint32_t at, uint64_t& first, uint64_t& end) const {
        const uint32_t count = bits_of(nodes_[at].primitives);
        if (count == 0) return 0;
        first = std::min<uint64_t>(first, nodes_[at].first_leaf);
        end = std::max<uint64_t>(end, nodes_[at].first_leaf + count);
        return count;
    }
    template <class NodeBox, class LeafBox>
    RefitBox update(uint32_t at, NodeBox&& node_box, LeafBox&& leaf_box, const RefitUnit& unit, RefitAreas& areas) const {
        cwbvh_node& node = nodes_[at];
        RefitBox whole, boxes[kWidth];
        uint32_t child = node.first_child, first = node.first_leaf, used = 0;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            const uint32_t count = primitives_of(node.primitives >> 4 * slot & 15u);
            const bool inner = CWBVH_INNER(&node) >> slot & 1u;
            if (!inner && count == 0) continue;
            RefitBox& fresh = boxes[slot];
            if (inner) {
                fresh = node_box(child++);
                areas.nodes = areas.nodes + unit.area(fresh);
            } else {
                fresh = leaf_box(first, count);
                first += count;
                areas.primitives = areas.primitives + unit.area(fresh) * splat(static_cast<float>(count));
            }
            whole.add(fresh);
            used |= 1u << slot;
        }
        Bounds8 rows;
        for (int half = 0; half < 2; ++half) {
            const RefitBox* const four = boxes + 4 * half;
            transpose4(four[0].lo, four[1].lo, four[2].lo, four[3].lo, rows.lo[0][half], rows.lo[1][half], rows.lo[2][half]);
            transpose4(four[0].hi, four[1].hi, four[2].hi, four[3].hi, rows.hi[0][half], rows.hi[1][half], rows.hi[2][half]);
        }
        quantize(rows, used, node);
        return whole;
    }
    void finish(uint32_t, const RefitBox&) const {}

 private:
    cwbvh_node* const nodes_;
    const GroupEnds ends_;
    const rt_refit_input* const in_;
};

// The children of a node as codes of topology.hpp.
std::array<uint32_t, 8> codes_of(const cwbvh_node& node) {
    std::array<uint32_t, 8> codes;
    uint32_t child = node.first_child, first = node.first_leaf;
    for (uint32_t slot = 0; slot < 8; ++slot) {
        const uint32_t count = primitives_of(node.primitives >> 4 * slot & 15u);
        const bool inner = CWBVH_INNER(&node) >> slot & 1u;
        codes[slot] = inner ? child++ : count > 0 ? make_leaf(first, count) : kEmpty;
        first += count;
    }
    return codes;
}

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    CompressedRefit layout(static_cast<cwbvh_node*>(out->slots[0]), in);
    const Rules rules = wide_rules(in->params);
    Refit<CompressedRefit>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

// On the device: see rt_device.h.
int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const cwbvh_node*>(built->slots[0]);
    return find_ranges(host, built, group, out, [&](uint32_t at) { return codes_of(nodes[at]); });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const Rules rules = wide_rules(params);
    return plan_refit(plan, "cwbvh_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

// Lists the boxes of one level of a group's tree, for drawing. These are the quantised boxes that rays
// are tested against, so they are wider than their contents.
struct Box {
    float lo[3], hi[3];
};

Box rounded(const cwbvh_node& node, rt_u32 slot) {
    double lo[3], hi[3];
    box_of(node, slot, lo, hi);
    Box box;
    for (int a = 0; a < 3; ++a) {
        box.lo[a] = static_cast<float>(std::clamp<double>(lo[a], -FLT_MAX, FLT_MAX));
        box.hi[a] = static_cast<float>(std::clamp<double>(hi[a], -FLT_MAX, FLT_MAX));
    }
    return box;
}

// Calls do_one(box, child) for every child of a node. `child` is RT_NONE for a leaf.
template <class Body>
void each_child(const cwbvh_node& node, Body&& do_one) {
    rt_u32 next = node.first_child;
    for (rt_u32 slot = 0; slot < 8; ++slot) {
        if (CWBVH_INNER(&node) >> slot & 1u)
            do_one(rounded(node, slot), next++);
        else if (node.primitives >> 4 * slot & 15u)
            do_one(rounded(node, slot), RT_NONE);
    }
}

// Passes the boxes of `level` to the sink: 0 is the root's box, RT_LEVEL_BOTTOM is all leaves. Throws if the group does not
// exist.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* nodes = static_cast<const cwbvh_node*>(built->slots[0]);
    const auto show = [&](const Box& box) { sink->box(sink->ctx, box.lo, box.hi); };
    if (level == 0) {
        Box whole;
        std::fill_n(whole.lo, 3, FLT_MAX);
        std::fill_n(whole.hi, 3, -FLT_MAX);
        each_child(nodes[built->roots[group]], [&](const Box& box, rt_u32) {
            for (int a = 0; a < 3; ++a) {
                whole.lo[a] = std::min(whole.lo[a], box.lo[a]);
                whole.hi[a] = std::max(whole.hi[a], box.hi[a]);
            }
        });
        if (whole.lo[0] <= whole.hi[0]) show(whole);
        return RT_OK;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{built->roots[group], 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        each_child(nodes[at.node], [&](const Box& box, rt_u32 child) {
            if (level == RT_LEVEL_BOTTOM ? child == RT_NONE : at.level == level)
                show(box);
            else if (child != RT_NONE)
                stack.push_back({child, at.level + 1});
        });
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "cwbvh.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<cwbvh_node>("cwbvh_nodes", "cwbvh_node")};
static_assert(sizeof(cwbvh_node) == 80, "five loads of 16 bytes");
constexpr rt_cl_file kTypes = rt::file(kFiles, "cwbvh_types.h"), kTraversal = rt::file(kFiles, "cwbvh.cl");

constexpr rt_param kParams[] = {
    max_leaf_param(CWBVH_LEAF_MAX, CWBVH_LEAF_MAX),
    bins_param(),
    traversal_param(3),
    intersection_param(1),
    builder_param(),
    duplicates_param(),
};
static_assert(std::size(kParams) == kOwnParams, "in the order of WideParam");

constexpr rt_accel kAccel = rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>,
                                      rt::Traits().merit(0.5f, 1.35f), rt::guarded<pack_trees<pack, CWBVH_LEAF_MAX>>);

constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_device_build kDeviceRefit =
    rt::device_refit(rt::file(kFiles, "cwbvh_build.cl"), rt::guarded<device_ranges>, rt::guarded<device_refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::extension(kDeviceRefit), rt::kNoMoreExtensions};
static_assert(kAccel.types.text && kAccel.traverse.text && kDeviceRefit.kernels.text, "the kernel files are embedded");

}  // namespace
}  // namespace cwbvh

const rt_plugin rt_plugin_v1 =
    rt::with_extensions(rt::accel_plugin("cwbvh", "Compressed 8-wide BVH for GPUs (binned SAH)", "1.0.0",
                                         "Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs "
                                         "Through Compressed Wide BVHs",
                                         cwbvh::kParams, cwbvh::kAccel),
                        cwbvh::kExtensions);
