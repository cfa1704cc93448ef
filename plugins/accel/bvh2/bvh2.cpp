// bvh2.cpp -- the plugin of the binary BVH (binned surface area heuristic, SAH): its table and its build entry.
//
// Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". A node takes 64 bytes. n primitives make
// at most n - 1 nodes. The build measures the depth of the tree and defines the stack size of the traversal (BVH2_STACK) from
// it. The structure suits static scenes. It is weak where large and small primitives overlap; there builder=spatial helps.
#include "clarity_bvh/assemble.hpp"
#include "levels.hpp"
#include "pack.hpp"
#include "parameters.hpp"
#include "refit.hpp"
#include "rt_plugin.hpp"

namespace bvh2 {
namespace {

constexpr rt_cl_file kFiles[] = {
#include "bvh2.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh2_node>("bvh2_nodes", "bvh2_node")};
constexpr rt_accel kAccel =
    rt::accel(kSlots, rt::file(kFiles, "bvh2_types.h"), rt::file(kFiles, "bvh2.cl"), rt::guarded<build>, rt::guarded<levels>,
              rt::Traits().merit(1, 1), rt::guarded<clarity::bvh::pack_trees<pack, BVH2_LEAF_MAX>>);
constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::kNoMoreExtensions};
static_assert(sizeof(bvh2_node) == 64, "a node is a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh2

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("bvh2", "Binary BVH (binned SAH)", "1.0.0",
                     "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies", bvh2::kParams, bvh2::kAccel),
    bvh2::kExtensions);
