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
#include "clarity_bvh/levels.hpp"
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

// The boxes are the quantised ones that rays are tested against, so they are wider than their contents.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    const auto* nodes = static_cast<const cwbvh_node*>(built->slots[0]);
    show_level(host, built, group, level, sink, [&](rt_u32 at, const auto& visit) {
        const cwbvh_node& node = nodes[at];
        rt_u32 next = node.first_child;
        for (rt_u32 slot = 0; slot < 8; ++slot) {
            const bool inner = CWBVH_INNER(&node) >> slot & 1u;
            if (!inner && !(node.primitives >> 4 * slot & 15u)) continue;
            double lo[3], hi[3];
            box_of(node, slot, lo, hi);
            float box[6];
            for (int a = 0; a < 3; ++a) {
                box[a] = static_cast<float>(std::clamp<double>(lo[a], -FLT_MAX, FLT_MAX));
                box[3 + a] = static_cast<float>(std::clamp<double>(hi[a], -FLT_MAX, FLT_MAX));
            }
            visit(box, inner ? next++ : RT_NONE);
        }
    });
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
    reinsert_param(),
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
