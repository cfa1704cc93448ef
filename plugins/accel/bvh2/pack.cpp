#include "pack.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "clarity_bvh/build/builder.hpp"
#include "clarity_bvh/pack_binary.hpp"
#include "clarity_bvh/rules.hpp"
#include "parameters.hpp"
#include "rt_cost.hpp"
#include "rt_plugin.h"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"

namespace bvh2 {
namespace {

using namespace clarity::bvh;

struct Statistics {
    uint64_t leaves = 0;
    rt::ExpectedCost expected;
};

double root_area(const bvh2_node& root) {
    float box[6];
    const bool one = root.child1 == BVH2_MAKE_LEAF(0u, 0u);
    for (int i = 0; i < 3; ++i) {
        box[i] = one ? root.box0[i] : std::min(root.box0[i], root.box1[i]);
        box[3 + i] = one ? root.box0[3 + i] : std::max(root.box0[3 + i], root.box1[3 + i]);
    }
    return rt::surface_of(box);
}

struct MeasuredPart {
    uint32_t group;
    rt_u32 begin, end;
    uint64_t leaves = 0;
    rt::Surfaces surfaces{};
    void add(const float box[6], rt_u32 child) {
        if (!(child & BVH2_LEAF)) {
            surfaces.add_node(rt::surface_of(box));
        } else if (BVH2_LEAF_COUNT(child) > 0) {
            ++leaves;
            surfaces.add_leaf(rt::surface_of(box), BVH2_LEAF_COUNT(child));
        }
    }
};

// Measures the trees, on all cores. The nodes of group g begin at roots[g] and end where those of the next group begin, or at
// node_count.
Statistics measure(const rt_host* host, const bvh2_node* nodes, rt_u32 node_count, const std::vector<rt_u32>& roots,
                   const rt_group* groups) {
    constexpr rt_u32 kPart = 8192;
    std::vector<MeasuredPart> parts;
    for (uint32_t g = 0; g < roots.size(); ++g) {
        const rt_u32 end = g + 1 < roots.size() ? roots[g + 1] : node_count;
        for (rt_u32 at = roots[g]; at < end; at = parts.back().end) parts.push_back({g, at, std::min(at + kPart, end)});
    }
    rt::parallel_for(host, static_cast<rt_u32>(parts.size()), [&](uint32_t p) {
        for (rt_u32 i = parts[p].begin; i < parts[p].end; ++i) {
            parts[p].add(nodes[i].box0, nodes[i].child0);
            parts[p].add(nodes[i].box1, nodes[i].child1);
        }
    });

    Statistics result;
    size_t at = 0;
    for (uint32_t g = 0; g < roots.size(); ++g) {
        const double whole = root_area(nodes[roots[g]]);
        rt::Surfaces sums;
        sums.add_node(whole);
        for (; at < parts.size() && parts[at].group == g; ++at) {
            result.leaves += parts[at].leaves;
            sums.add(parts[at].surfaces);
        }
        result.expected.add_group(groups[g].count, whole, sums);
    }
    return result;
}

static_assert(BVH2_MAKE_LEAF(0u, 0u) == kEmpty && BVH2_MAKE_LEAF(5u, 3u) == make_leaf(5, 3) && BVH2_LEAF_MAX == kLeafMax,
              "the library's codes of children");

// The layouts are the same, so a node is copied whole.
static_assert(sizeof(bvh2_node) == sizeof(Node) && offsetof(bvh2_node, child0) == offsetof(Node, child0) &&
                  offsetof(bvh2_node, box1) == offsetof(Node, box1) && offsetof(bvh2_node, child1) == offsetof(Node, child1),
              "a bvh2_node is a Node");
void convert(bvh2_node& to, const Node& from) {
    std::memcpy(&to, &from, sizeof to);
    to.pad0 = to.pad1 = 0;
}

// Writes slot 0, the roots, the defines and the statistics. The leaf order is written already.
void write(const rt_host* host, const rt_build_input& input, const Topology& topology, uint64_t build_bytes,
           const rt_build_output* out) {
    const bvh2_node* nodes = nullptr;
    rt_u32 count = 0;
    const std::vector<rt_u32> roots = pack_binary(
        host, topology,
        [&](uint32_t node_count) {
            count = node_count;
            bvh2_node* const memory = rt::alloc<bvh2_node>(out, 0, node_count);
            nodes = memory;
            return memory;
        },
        convert);
    for (rt_u32 g = 0; g < roots.size(); ++g) rt::root(out, g, roots[g]);
    const Rules rules = rules_of(input.params);
    const Statistics statistics = measure(host, nodes, count, roots, input.groups);
    rt::stat(out, "nodes", count);
    rt::stat(out, "leaves", static_cast<double>(statistics.leaves));
    rt::stat(out, "depth", topology.depth);
    rt::stat(out, "references", static_cast<double>(topology.ref_count));
    rt::stat(out, "sah_cost", statistics.expected.weighted(rules.traversal_cost, rules.intersection_cost));
    statistics.expected.report(out);
    rt::stat(out, "build_bytes", static_cast<double>(build_bytes));
    // The traversal needs one stack entry a level, and one more to tell a full stack from an overflow. The size is a multiple
    // of 8, because a new value recompiles the kernels.
    rt::define(out, "BVH2_STACK", (topology.depth + 1 + 7) / 8 * 8);
}

}  // namespace

void pack(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
          const rt_build_output* out) {
    std::copy_n(refs, topology.ref_count, rt::leaves(out, topology.ref_count));
    write(host, input, topology, topology.nodes.count() * sizeof(Node), out);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    const Rules rules = rules_of(input->params);
    const Topology topology = build_topology(host, *input, rules, [out](uint64_t refs) { return rt::leaves(out, refs); });
    write(host, *input, topology, build_bytes(rules, count_primitives(host, *input)), out);
    return RT_OK;
}

}  // namespace bvh2
