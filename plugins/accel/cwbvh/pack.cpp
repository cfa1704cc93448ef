#include "pack.hpp"

#include <memory>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/wide/octant_slots.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "compress.hpp"

namespace cwbvh {
namespace {

using namespace clarity::bvh;

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
