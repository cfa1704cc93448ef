/* rt_refit.h -- the extension `refit`, version 1, frozen: a finished structure follows primitives that moved, without a new build.
 *
 * A structure that offers it has an rt_extension of the name RT_REFIT and version RT_REFIT_VERSION, whose data is an rt_refit. Where
 * one plugin builds a topology and another packs it, the other one refits. The host keeps the slots of a finished build, moves
 * primitives, and calls `refit`, which writes new bounding volumes into the same slots.
 *
 * What may change: the bounding volumes of the nodes of changed groups, and triangles that the structure has packed itself. What may
 * not: sizes of slots, roots, leaf order, defines, which children and which positions in leaf order a node has, and all that
 * belongs to groups that are not changed. A tree that is refitted stays right and becomes slower, the more the primitives' order in
 * space differs from that of the build: `cost` tells how much.
 *
 * Volumes must hold the whole primitives, also where the build had cut them (spatial splits). They must be right for every motion:
 * primitives may fall together in a point, or grow by many powers of ten.
 *
 * Structs grow as those of rt_plugin.h do: fields are appended, and what a plugin or a host does not have reads as zero. */
#ifndef RT_REFIT_H
#define RT_REFIT_H
#include "rt_plugin.h"

#define RT_REFIT "refit"
#define RT_REFIT_VERSION 1u

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rt_refit_input {
    rt_u32 struct_bytes, group_count;
    const uint8_t *changed;      /* group g is refitted if changed[g] is not 0 */
    const rt_u32 *roots;         /* one for each group, as `build` reported them */
    const uint64_t *slot_counts; /* elements of each slot */
    uint64_t leaf_count;         /* positions in leaf order, of all groups */
    const double *params;        /* those that the structure was built with */
    void *ctx;
    /* Writes the primitives at `count` positions in leaf order from `first` on, as they are now: their boxes, which are finite and
     * whose lo is never above hi, and refs; `mesh` is 0. The host packs the same positions of its own leaves meanwhile, so ask for
     * each position of the changed groups exactly once, and for no other. It costs little to call it for some hundred positions, so
     * that they are still in a cache when they are read. Returns RT_OK, or RT_FAILED if there are no such positions: then return
     * RT_FAILED. [any thread of parallel_for] */
    int32_t (*prims)(void *ctx, uint64_t first, uint64_t count, rt_prim *prims);
    /* The host's leaves, for structures that pack triangles themselves. A position is up to date once `prims` was asked for it. */
    const rt_packed_prim *leaves;
} rt_refit_input;

typedef struct rt_refit_output {
    rt_u32 struct_bytes, pad;
    void *const *slots; /* as `build` or the last `refit` left them; no other thread reads or writes them during the call */
    void *ctx;
    /* The expected cost of a ray that hits the box of a changed group, by the same measure each time, such as the surface area
     * heuristic. The host compares it with that of other refits of the same build. Call it once for each changed group whose cost is
     * known. It is finite; 0: no ray hits a point or a line. [any thread of parallel_for] */
    void (*cost)(void *ctx, rt_u32 group, double cost);
} rt_refit_output;

typedef struct rt_refit {
    rt_u32 struct_bytes, pad;
    /* Returns RT_OK, RT_FAILED after host->fail, or RT_CANCELLED after host->progress asked for it. After any other result than RT_OK
     * the host does not use the volumes of the changed groups: it refits these groups again, or builds. The bytes must not depend on
     * the number and order of threads. [worker thread] */
    int32_t (*refit)(const rt_host *, const rt_refit_input *, const rt_refit_output *);
} rt_refit;

#ifdef __cplusplus
}
#endif
#endif
