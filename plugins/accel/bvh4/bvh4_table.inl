// bvh4_table.inl -- bounding volume hierarchy of four children a node, for one ray at a time on GPUs: what of bvh8.cpp, which
// includes it, is this plugin's own.
//
// bvh8's builder, of another width: 128 bytes a node, 66 to 68 a triangle with the triangle itself. A GPU's thread has registers
// for four boxes at once, fetched by seven loads; in a binary tree it would wait for twice as many fetches, one after the other.
constexpr rt_cl_file kFiles[] = {
#include "bvh4.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh8_node>("bvh4_nodes", "bvh4_node")};
static_assert(sizeof(bvh8_node) == 128, "a node is a line of a GPU's cache");
constexpr const char *kId = "bvh4", *kName = "4-wide BVH for GPUs (binned SAH, collapsed)", *kStack = "BVH4_STACK";
constexpr rt_cl_file kTypes = rt::file(kFiles, "bvh4_types.h"), kTraversal = rt::file(kFiles, "bvh4.cl");
constexpr rt::Traits kTraits =
    rt::Traits().can(RT_TRAVERSES_STEPS | RT_TRAVERSES_WARPS | RT_REQUEUES_LONG_RAYS).merit(0.75f, 1.64f);
constexpr int kLeafSize = 4;
constexpr double kLeafCost = 1;
