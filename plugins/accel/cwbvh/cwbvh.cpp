// cwbvh.cpp -- the plugin of the compressed BVH with eight children a node, for scenes that fill a GPU's memory.
//
// It is bvh8's tree with each box rounded outwards to a grid of 255 steps a node. A node takes 80 bytes instead of 224. A
// triangle takes 55 bytes, its own record included; with bvh4 it takes 67.
#include <iterator>
#include <memory>

#include "compress.hpp"
#include "compressed_levels.hpp"
#include "scratch.hpp"
#include "wide_build.hpp"

namespace cwbvh {
namespace {

using bvh8::kOwnParams;

constexpr rt_cl_file kFiles[] = {
#include "cwbvh.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<cwbvh_node>("cwbvh_nodes", "cwbvh_node")};
static_assert(sizeof(cwbvh_node) == 80, "five loads of 16 bytes");
constexpr rt_cl_file kTypes = rt::file(kFiles, "cwbvh_types.h"), kTraversal = rt::file(kFiles, "cwbvh.cl");

constexpr rt_param kParams[] = {
    bvh8::max_leaf_param(CWBVH_LEAF_MAX, CWBVH_LEAF_MAX),
    bvh8::kBinsParam,
    bvh8::kTraversalParam,
    bvh8::intersection_param(1),
    bvh8::kBuilderParam,
    bvh8::kDuplicatesParam,
};
static_assert(std::size(kParams) == kOwnParams, "in the order of bvh8::Param");

// Receives the output of bvh8's builder in memory of its own, to be compressed and then freed.
struct Catch {
    explicit Catch(rt_u32 group_count) : roots(group_count) {
        table.struct_bytes = sizeof table;
        table.ctx = this;
        table.alloc = [](void* ctx, rt_u32, uint64_t count) -> void* {
            Catch& own = *static_cast<Catch*>(ctx);
            own.nodes = std::make_unique<bvh2::Scratch<bvh8_node>>(count);
            return own.nodes->data();
        };
        table.leaves = [](void* ctx, uint64_t count) {
            Catch& own = *static_cast<Catch*>(ctx);
            own.refs = std::make_unique<bvh2::Scratch<rt_u32>>(count);
            return own.refs->data();
        };
        table.root = [](void* ctx, rt_u32 group, rt_u32 node) { static_cast<Catch*>(ctx)->roots[group] = node; };
    }
    rt_build_output table{};
    std::unique_ptr<bvh2::Scratch<bvh8_node>> nodes;
    std::unique_ptr<bvh2::Scratch<rt_u32>> refs;
    std::vector<rt_u32> roots;
};

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    Catch caught(input->group_count);
    const bvh8::WideBuild wide = bvh8::build_wide(host, input, &caught.table);
    rt::progress(host, 0.97f);  // build_wide() does not report the progress of the compression
    compress(host, {caught.nodes->data(), wide.nodes, caught.refs->data(), wide.references, &caught.roots}, out);
    bvh8::report(out, wide, uint64_t{wide.nodes} * sizeof(cwbvh_node));
    // A single ray defers the rest of a node as one entry, so its stack follows the depth. A packet defers each child.
    rt::define(out, "CWBVH_DEPTH", bvh8::stack_places(wide.depth));
    rt::define(out, "CWBVH_STACK", bvh8::stack_places(wide.stack));
    return RT_OK;
}

constexpr rt_accel kAccel =
    rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>, rt::Traits().merit(0.5f, 1.35f));

static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace cwbvh

const rt_plugin rt_plugin_v1 = rt::accel_plugin("cwbvh", "Compressed 8-wide BVH for GPUs (binned SAH)", "1.0.0",
                                                "Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs "
                                                "Through Compressed Wide BVHs",
                                                cwbvh::kParams, cwbvh::kAccel);
