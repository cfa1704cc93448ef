#include "pack.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "clarity_bvh/base/scratch.hpp"
#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/wide/octant_slots.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "quantize.hpp"
#include "rt_plugin.hpp"

namespace cwbvh {
namespace {

using namespace clarity::bvh;

// Converts a finished 8-wide tree to compressed nodes.

// An 8-wide tree: its nodes in depth-first order, its leaf order, and the roots of its groups.
struct WideNodes {
    const WideNode* nodes;
    rt_u32 node_count;
    const rt_u32* refs;
    uint64_t ref_count;
    const std::vector<rt_u32>* roots;
};

constexpr rt_u32 kChunk = 4096;  // nodes per task

bool is_node(rt_u32 child) {
    return !is_leaf(child);
}

// The numbers of children and primitives directly below the nodes of a chunk; later the sums over all earlier chunks.
struct Below {
    uint64_t nodes = 0, primitives = 0;
};

Below below(const cwbvh::WideNode& node) {
    Below sum;
    for (const rt_u32 child : node.child) {
        if (is_node(child))
            ++sum.nodes;
        else
            sum.primitives += leaf_count(child);
    }
    return sum;
}

// Writes slot 0 and the leaf order, and reports the roots, on all cores. The output is in the order of the parents: the
// children of a node are stored together, in the order of their parents, and so are its primitives. Both positions are sums
// over all earlier nodes. So each part of the tree can be written independently of the others.
void compress(const rt_host* host, const WideNodes& wide, const rt_build_output* out) {
    const rt_u32 chunk_count = (wide.node_count + kChunk - 1) / kChunk;
    std::vector<rt_u32> roots = *wide.roots;
    std::sort(roots.begin(), roots.end());
    const auto each_of = [&](rt_u32 chunk, const auto& do_one) {
        const rt_u32 begin = chunk * kChunk, end = std::min(wide.node_count, begin + kChunk);
        auto root = std::lower_bound(roots.begin(), roots.end(), begin);
        for (rt_u32 i = begin; i < end; ++i) {
            const bool is_root = root != roots.end() && *root == i;
            if (is_root) ++root;
            do_one(i, is_root);
        }
    };
    std::vector<Below> before(chunk_count);
    rt::parallel_for(host, chunk_count, [&](rt_u32 c) {
        each_of(c, [&](rt_u32 i, bool is_root) {
            const Below own = below(wide.nodes[i]);
            before[c].nodes += own.nodes + (is_root ? 1 : 0);
            before[c].primitives += own.primitives;
        });
    });
    Below sum;
    for (Below& chunk : before) {
        const Below own = chunk;
        chunk = sum;
        sum.nodes += own.nodes;
        sum.primitives += own.primitives;
    }

    // The index of a node depends on its parent, so all indices are computed before any node is written. A root comes before
    // its children, so that the nodes of a group stand together.
    const Scratch<rt_u32> place(wide.node_count);
    rt::parallel_for(host, chunk_count, [&](rt_u32 c) {
        auto next = static_cast<rt_u32>(before[c].nodes);
        each_of(c, [&](rt_u32 i, bool is_root) {
            if (is_root) place.data()[i] = next++;
            for (const rt_u32 child : wide.nodes[i].child)
                if (is_node(child)) place.data()[child] = next++;
        });
    });
    for (rt_u32 g = 0; g < roots.size(); ++g) rt::root(out, g, place.data()[(*wide.roots)[g]]);

    auto* const nodes = rt::alloc<cwbvh_node>(out, 0, wide.node_count);
    rt_u32* const refs = rt::leaves(out, wide.ref_count);
    rt::parallel_for(host, chunk_count, [&](rt_u32 c) {
        auto next_child = static_cast<rt_u32>(before[c].nodes), next_leaf = static_cast<rt_u32>(before[c].primitives);
        each_of(c, [&](rt_u32 i, bool is_root) {
            const cwbvh::WideNode& from = wide.nodes[i];
            cwbvh_node to{};
            if (is_root) ++next_child;
            to.first_child = next_child;
            to.first_leaf = next_leaf;
            for (rt_u32 slot = 0; slot < 8; ++slot) {
                const rt_u32 child = from.child[slot];
                if (is_node(child)) {
                    to.cells |= 1u << (24 + slot);
                    ++next_child;
                    continue;
                }
                const rt_u32 count = leaf_count(child);
                to.primitives |= ((1u << count) - 1u) << 4 * slot;
                std::copy_n(wide.refs + leaf_first(child), count, refs + next_leaf);
                next_leaf += count;
            }
            quantize(from, to);
            nodes[place.data()[i]] = to;
        });
    });
}

constexpr WideLayout<8> kLayout{write_octant_node, nullptr};

// The 8-wide tree in memory of its own, to be compressed and then freed.
struct Caught {
    explicit Caught(rt_u32 group_count) : roots(group_count) {}
    WideOutput<8> output() {
        return {[this](uint64_t count) {
                    nodes = std::make_unique<Scratch<cwbvh::WideNode>>(count);
                    return nodes->data();
                },
                [this](uint32_t group, uint32_t node) { roots[group] = node; }};
    }
    std::unique_ptr<Scratch<cwbvh::WideNode>> nodes;
    std::vector<rt_u32> roots;
};

void finish(const rt_host* host, const Caught& caught, const WideBuild& wide, const rt_u32* refs, const rt_build_output* out) {
    rt::progress(host, 0.97f);  // the build does not report the progress of the compression
    compress(host, {caught.nodes->data(), wide.nodes, refs, wide.references, &caught.roots}, out);
    report(out, wide, uint64_t{wide.nodes} * sizeof(cwbvh_node));
    // A single ray defers the rest of a node as one entry, so its stack follows the depth. A packet defers each child.
    rt::define(out, "CWBVH_DEPTH", stack_places(wide.depth));
    rt::define(out, "CWBVH_STACK", stack_places(wide.stack));
}

}  // namespace

void pack(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
          const rt_build_output* out) {
    Caught caught(input.group_count);
    const WideBuild wide = pack_wide(host, topology, input.groups, input.group_count, wide_costs(wide_rules(input.params)),
                                     kLayout, caught.output());
    finish(host, caught, wide, refs, out);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    Caught caught(input->group_count);
    std::unique_ptr<Scratch<rt_u32>> refs;
    const RefMemory refs_of = [&](uint64_t count) {
        refs = std::make_unique<Scratch<rt_u32>>(count);
        return refs->data();
    };
    const WideBuild wide = build_wide(host, *input, wide_rules(input->params), kLayout, refs_of, caught.output());
    finish(host, caught, wide, refs->data(), out);
    return RT_OK;
}

}  // namespace cwbvh
