// bvh4_table.inl -- the parts of bvh8.cpp (which includes this file) that differ for bvh4: a BVH with four children a node, for
// single rays on GPUs.
//
// It uses bvh8's builder with another width. A node takes 128 bytes; a triangle takes 66 to 68 bytes, its own record included.
// A GPU thread has registers for four boxes at once, which seven loads fetch. In a binary tree, the thread would wait for twice
// as many dependent fetches.
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
