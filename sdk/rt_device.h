/* rt_device.h -- the extension `device_build`, version 1, frozen: structures that are built, or refitted, on the device that traces
 * them.
 *
 * A structure that offers it has an rt_extension of the name RT_DEVICE_BUILD and version RT_DEVICE_BUILD_VERSION, whose data is an
 * rt_device_build. A plugin does not build there itself: it makes a *plan*, for a number of primitives. A plan is a list of steps:
 * kernels of the plugin's own, and sorts, scans and reductions of the host's. The host takes the plan's memory once, and carries the
 * plan out each time the primitives have moved. So a rebuild runs no code of the plugin, allocates nothing and sends nothing to the
 * host and back.
 *
 * A structure that builds only a topology (rt_accel::topology) plans that; its layout (rt_accel::pack) plans the nodes that it
 * traces, and their refit. A plugin with slots and a builder of its own may have all, or the refit alone. A plugin that has an
 * rt_device_build builds on the host, too, for devices that cannot run it.
 *
 * Planning: the functions of rt_device_build run on one worker thread at a time for each plan. They return RT_OK, or RT_FAILED after
 * host->fail or after a call of the plan has failed; the host then builds or refits by itself and says why. Tables and arrays that
 * they are given, and the plan, are valid during the call. The host owns all buffers. A buffer is a number, which is valid in its
 * plan only.
 *
 * Carrying out: steps run one after the other, each run after the one before it. Boxes differ from run to run, and nothing else that
 * the plan was made with. Buffers keep their content, so a run begins with what the last one left: a counter is cleared by a step.
 * Boxes are finite, lo is never above hi; they may fall together in a point, and grow by many powers of ten. Leaf order, boxes and
 * which primitives a node holds depend on nothing but the input; numbers of nodes may differ from run to run.
 *
 * Kernels are OpenCL C 1.2, behind cl/build/groups.h and cl/build/blocks.h. Of these, version 1 freezes: RT_GROUP, RT_BUILD_KERNEL,
 * RT_ITEM, RT_GROUP_NUMBER, RT_INLINE, RT_LOCAL_BARRIER, RT_GLOBAL_BARRIER, RT_WARPS and what goes with it; rt_block,
 * rt_build_box, rt_no_block, rt_join_blocks, rt_block_area, rt_box_of_range. A group has RT_GROUP work-items: a power of two, 1 to
 * 256. It is 1 on a CPU, where a work-item does a group's work in a loop. No group may wait for another, and nothing that a group
 * writes is read by another group of the same launch, unless there are warps (RT_WARPS) and both use RT_DEVICE_FENCE.
 *
 * Limits: RT_REF_INDEX_MAX primitives in a group, RT_DEVICE_BUFFERS buffers and RT_DEVICE_STEPS steps in a plan.
 *
 * Structs grow as those of rt_plugin.h do: fields are appended, and what a plugin or a host does not have reads as zero. */
#ifndef RT_DEVICE_H
#define RT_DEVICE_H
#include "rt_plugin.h"

#define RT_DEVICE_BUILD "device_build"
#define RT_DEVICE_BUILD_VERSION 1u
/* The most of a plan. */
#define RT_DEVICE_BUFFERS 1024u
#define RT_DEVICE_STEPS 4096u

#ifdef __cplusplus
extern "C" {
#endif

/* An argument of a kernel: a buffer, or a number of 4 bytes (uint, int, float) if buffer is RT_NONE. 8 B; it never grows. */
typedef struct rt_device_arg {
    rt_u32 buffer; /* as the host named it */
    rt_u32 value;  /* the number's bits */
} rt_device_arg;

/* The host's side of a plan. Calls that return int32_t return RT_OK, or RT_FAILED with the error recorded: then return RT_FAILED. All
 * later calls of the plan fail, too. Sizes of buffers are checked: a step that would reach beyond one is refused, except in kernels
 * of the plugin's own. Steps for no elements are allowed and do nothing. [the thread that plans] */
typedef struct rt_device_plan {
    rt_u32 struct_bytes;
    rt_u32 group_items; /* RT_GROUP */
    rt_u32 units;       /* compute units of the device */
    rt_u32 has_warps;   /* 1: kernels have RT_WARPS */
    void *ctx;
    /* Memory of the plan, aligned for every type. It is filled with zeros once, while the plan is made. RT_NONE: failed. */
    rt_u32 (*buffer)(void *ctx, uint64_t bytes);
    /* A step: `groups` work-groups of group_items work-items of a kernel in rt_device_build::kernels, with all of its arguments, in
     * their order; arguments in local memory are not possible. */
    int32_t (*launch)(void *ctx, const char *kernel, rt_u32 groups, const rt_device_arg *args, rt_u32 arg_count);
    /* A step: the first `words` uints of a buffer become `value`. */
    int32_t (*fill)(void *ctx, rt_u32 buffer, uint64_t words, rt_u32 value);
    /* A step: sorts keys (ulong) and values (uint) by the lowest `bits` bits (1 to 64) of the keys; pairs with equal bits keep their
     * order. */
    int32_t (*sort)(void *ctx, rt_u32 keys, rt_u32 values, uint64_t count, rt_u32 bits);
    /* A step: each uint becomes the sum of those before it, modulo 2^32. */
    int32_t (*scan)(void *ctx, rt_u32 data, uint64_t count);
    /* A step: the bounds of `count` boxes (rt_prim) as 12 floats: least corner of the boxes and of their centres lo / 2 + hi / 2, then
     * the greatest. Of no boxes: +inf, then -inf. */
    int32_t (*bounds)(void *ctx, rt_u32 boxes, uint64_t count, rt_u32 result);
    /* A step: the blocks (rt_block) of `count` boxes (rt_prim), from which rt_box_of_range gives the box of neighbours. order: a buffer
     * of uint, which box stands at each place; RT_NONE: as they are. Returns their buffer; RT_NONE: failed. */
    rt_u32 (*blocks)(void *ctx, rt_u32 boxes, rt_u32 order, uint64_t count);
    /* A step: puts `count` boxes (rt_prim) in the order of their centres along a Morton curve, with axis_bits (1 to 21) bits for each
     * axis, x before y before z from the highest bit on. keys (ulong): the codes, ascending; order (uint): the number of the box at
     * each place; boxes with equal codes keep their order. Cells are cubes, and hold all centres. */
    int32_t (*curve)(void *ctx, rt_u32 boxes, uint64_t count, rt_u32 axis_bits, rt_u32 keys, rt_u32 order);
} rt_device_plan;

/* The primitives of one group. */
typedef struct rt_device_input {
    rt_u32 struct_bytes;
    rt_u32 prims;         /* buffer of `count` rt_prim; only their boxes mean anything */
    uint64_t count;       /* 0 to RT_REF_INDEX_MAX; the same in each run */
    const double *params; /* the plugin's own */
} rt_device_input;

/* A binary tree over one group on the device. A tree of n primitives has n - 1 inner nodes. A child is the index of an inner node, or
 * RT_TOPOLOGY_LEAF | a place in `order`. The leaves below the left child come before those of the right one in leaf order. With one
 * primitive or none there are no nodes. */
typedef struct rt_device_topology {
    rt_u32 struct_bytes;
    rt_u32 nodes;  /* buffer of n - 1 rt_topology_node: the box of all that is below, left and right child */
    rt_u32 counts; /* buffer of uint, for each inner node: primitives below it */
    rt_u32 order;  /* buffer of uint: the number of the primitive at each place, 0 .. count - 1 */
    rt_u32 depth;  /* inner nodes on the way from the root to a leaf, at most, whatever the boxes are; RT_TOPOLOGY_DEPTH at most */
    rt_u32 root;   /* buffer of a uint: the inner node that is the root; RT_NONE: the first one */
} rt_device_topology;

/* The tree of one group in the layout's slots, which hold the trees of all groups. */
typedef struct rt_device_tree {
    rt_u32 struct_bytes, slot_count;
    const rt_u32 *slots;           /* buffers */
    const uint64_t *first_element; /* of each slot (for refit: of slot 0): where this tree's elements begin */
    const uint64_t *element_count; /* and how many there are at most */
    rt_u32 root;                   /* element of slot 0 */
    rt_u32 first_leaf;             /* position of the group's first primitive in leaf order */
    uint64_t count;                /* of its primitives; they stand side by side in leaf order */
    /* Buffer of two uints for each element of slot 0: of a node the first position below it, counted from first_leaf, and the number
     * of positions; of what is no node 0, 0. */
    rt_u32 ranges;
    rt_u32 pad;
} rt_device_tree;

/* The output of `pack`. */
typedef struct rt_device_output {
    rt_u32 struct_bytes;
    rt_u32 leaves; /* buffer of uint, to be written by steps: the numbers of the primitives in leaf order */
    void *ctx;
    /* The root: an element of slot 0 within the tree's. Call it once. */
    void (*root)(void *ctx, rt_u32 element);
    /* What kernels are compiled with (rt_build_output::define); of several trees the greatest value counts. It may depend on numbers
     * that the plan is made with, and not on boxes: the size of a stack follows rt_device_topology::depth. */
    void (*define)(void *ctx, const char *name, rt_u32 value);
} rt_device_output;

/* The ranges of a tree that was built on the host; all in host memory. */
typedef struct rt_tree_ranges {
    rt_u32 struct_bytes, pad;
    uint64_t first_element, element_count; /* of slot 0, to be written: where the nodes of the group are */
    rt_u32 *ranges; /* two for each element of slot 0, all 0: to be written as in rt_device_tree, but counted from 0 */
} rt_tree_ranges;

/* At least one of topology, pack and refit is not NULL. pack goes with elements and refit, refit with ranges. [worker thread] */
typedef struct rt_device_build {
    rt_u32 struct_bytes, pad;
    rt_cl_file kernels; /* "<id>_build.cl"; it may include parts, as a traversal may */
    /* Plans a tree over the primitives. */
    int32_t (*topology)(const rt_host *, const rt_device_plan *, const rt_device_input *, rt_device_topology *);
    /* The most elements of a slot that a tree of `count` primitives takes, whatever the boxes and the topology are. */
    uint64_t (*elements)(rt_u32 slot, uint64_t count, const double *params);
    /* Plans the tree in the layout's slots: nodes, ranges and leaf order. tree->root is not given: it is reported. Elements of other
     * trees are not written. */
    int32_t (*pack)(const rt_host *, const rt_device_plan *, const rt_device_input *, const rt_device_topology *,
                    const rt_device_tree *, const rt_device_output *);
    /* Finds the ranges of one group of a finished build, on the host. RT_FAILED if its positions do not stand side by side. */
    int32_t (*ranges)(const rt_host *, const rt_built *, rt_u32 group, rt_tree_ranges *);
    /* Plans that the bounding volumes of a tree are written again, and nothing else of it. The tree is one of `pack`, or one that the
     * host has built. blocks: of the boxes of its primitives in leaf order. costs: buffer of a float for each element of slot 0 of the
     * tree, to be written: its share of the expected cost of a ray, times the area of its tree's box; of what is no node 0. */
    int32_t (*refit)(const rt_host *, const rt_device_plan *, const rt_device_tree *, rt_u32 blocks, rt_u32 costs,
                     const double *params);
} rt_device_build;

#ifdef __cplusplus
}
#endif
#endif
