/* grid.c -- a plugin of ABI version 2 and kernel contract 1, kept as it was when they were frozen: do not edit it. A uniform grid.
 * Cells hold lists of positions in leaf order, so a primitive that reaches into many cells is packed once. */
#include "rt_plugin.h"

typedef struct frozen2_grid_head {
    rt_u32 first, count; /* cells of a group */
} frozen2_grid_head;
typedef struct frozen2_grid_cell {
    float box[6];
    rt_u32 first, count; /* range of the list */
} frozen2_grid_cell;
typedef struct frozen2_grid_bounds {
    float lo[3], hi[3];
} frozen2_grid_bounds;

enum { kHeads, kCells, kList, kBounds };

static frozen2_grid_bounds bounds_of(const rt_build_input *in, rt_u32 group) {
    frozen2_grid_bounds b = {{3e38f, 3e38f, 3e38f}, {-3e38f, -3e38f, -3e38f}};
    const rt_group range = in->groups[group];
    for (rt_u32 i = range.first; i < range.first + range.count; ++i)
        for (int k = 0; k < 3; ++k) {
            if (in->prims[i].lo[k] < b.lo[k]) b.lo[k] = in->prims[i].lo[k];
            if (in->prims[i].hi[k] > b.hi[k]) b.hi[k] = in->prims[i].hi[k];
        }
    return b;
}

/* The first and the last of n cells of an axis that a primitive reaches into, with a little slack at either end. */
static rt_u32 cell_of(float x, float lo, float hi, rt_u32 n, int slack) {
    const double at = hi > lo ? ((double)x - lo) / ((double)hi - lo) * n + 0.01 * slack : 0;
    return at < 0 ? 0 : at >= n ? n - 1 : (rt_u32)at;
}

static int32_t build(const rt_host *host, const rt_build_input *in, const rt_build_output *out) {
    const rt_u32 n = (rt_u32)in->params[0], per_group = n * n * n;
    if (!RT_HAS(in, rt_build_input, device) || in->device->struct_bytes < sizeof(rt_device))
        return host->fail(host->ctx, "the host does not say for which device it builds");
    uint64_t prims = 0, listed = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) prims += in->groups[g].count;
    rt_u32 *leaves = out->leaves(out->ctx, prims);
    frozen2_grid_head *heads = out->alloc(out->ctx, kHeads, in->group_count);
    frozen2_grid_cell *cells = out->alloc(out->ctx, kCells, (uint64_t)per_group * in->group_count);
    frozen2_grid_bounds *boxes = out->alloc(out->ctx, kBounds, in->group_count);
    if (!leaves || !heads || !cells || !boxes) return RT_FAILED;
    rt_u32 *list = NULL;
    for (int pass = 0; pass < 2; ++pass) { /* counts, then fills */
        rt_u32 at = 0;
        if (pass == 1) {
            list = out->alloc(out->ctx, kList, listed);
            if (!list) return RT_FAILED;
            rt_u32 next = 0;
            for (uint64_t c = 0; c < (uint64_t)per_group * in->group_count; ++c) {
                cells[c].first = next;
                next += cells[c].count;
                cells[c].count = 0;
            }
        }
        for (rt_u32 g = 0; g < in->group_count; ++g) {
            const frozen2_grid_bounds b = bounds_of(in, g);
            boxes[g] = b;
            heads[g].first = g * per_group;
            heads[g].count = in->groups[g].count > 0 ? per_group : 0;
            for (rt_u32 i = 0; i < in->groups[g].count; ++i, ++at) {
                const rt_prim *prim = in->prims + in->groups[g].first + i;
                rt_u32 from[3], to[3];
                for (int k = 0; k < 3; ++k) {
                    from[k] = cell_of(prim->lo[k], b.lo[k], b.hi[k], n, -1);
                    to[k] = cell_of(prim->hi[k], b.lo[k], b.hi[k], n, 1);
                }
                leaves[at] = prim->ref;
                for (rt_u32 z = from[2]; z <= to[2]; ++z)
                    for (rt_u32 y = from[1]; y <= to[1]; ++y)
                        for (rt_u32 x = from[0]; x <= to[0]; ++x) {
                            frozen2_grid_cell *cell = cells + heads[g].first + (z * n + y) * n + x;
                            /* A cell's box encloses all of its primitives, so no rounding of its planes can lose one. */
                            for (int k = 0; k < 3; ++k) {
                                if (cell->count == 0 || prim->lo[k] < cell->box[k]) cell->box[k] = prim->lo[k];
                                if (cell->count == 0 || prim->hi[k] > cell->box[k + 3]) cell->box[k + 3] = prim->hi[k];
                            }
                            if (list) list[cell->first + cell->count] = at;
                            ++cell->count;
                            ++listed;
                        }
            }
            if (!host->progress(host->ctx, (float)(pass * in->group_count + g) / (2.0f * in->group_count))) return RT_CANCELLED;
        }
    }
    for (rt_u32 g = 0; g < in->group_count; ++g) out->root(out->ctx, g, g);
    out->define(out->ctx, "FROZEN2_GRID_CELLS", per_group);
    out->stat(out->ctx, "nodes", (double)per_group * in->group_count);
    out->stat(out->ctx, "references", (double)(listed / 2));
    return RT_OK;
}

static int32_t levels(const rt_host *host, const rt_built *built, rt_u32 group, rt_u32 level, const rt_volume_sink *sink) {
    if (group >= built->group_count) return host->fail(host->ctx, "no such group");
    const frozen2_grid_head *head = (const frozen2_grid_head *)built->slots[kHeads] + built->roots[group];
    const frozen2_grid_cell *cells = (const frozen2_grid_cell *)built->slots[kCells] + head->first;
    const frozen2_grid_bounds *all = (const frozen2_grid_bounds *)built->slots[kBounds] + group;
    if (level == 0 && head->count > 0) sink->box(sink->ctx, all->lo, all->hi);
    for (rt_u32 i = 0; (level == 1 || level == RT_LEVEL_BOTTOM) && i < head->count; ++i)
        if (cells[i].count > 0) sink->box(sink->ctx, cells[i].box, cells[i].box + 3);
    return RT_OK;
}

static const char kTypes[] =
    "typedef struct frozen2_grid_head { rt_u32 first, count; } frozen2_grid_head;\n"
    "typedef struct frozen2_grid_cell { rt_f32 box[6]; rt_u32 first, count; } frozen2_grid_cell;\n";
static const char kTraverse[] =
    "#if RT_KERNEL_CONTRACT != 1 || !defined(FROZEN2_GRID_CELLS)\n"
    "#error \"written for contract 1\"\n"
    "#endif\n"
    "void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)\n"
    "{\n"
    "    const frozen2_grid_head head = ctx->frozen2_grid_heads[root];\n"
    "    for (uint c = 0; c < head.count; ++c) {\n"
    "        const global frozen2_grid_cell *cell = ctx->frozen2_grid_cells + head.first + c;\n"
    "        if (cell->count == 0u) continue;\n"
    "        vfloat entry;\n"
    "        const uint inside = rt_bits(rt_enter_box(cell->box, ray, hit, &entry));\n"
    "        RT_COUNT_VISIT(hit, inside);\n"
    "        if (inside == 0u) continue;\n"
    "        for (uint i = 0; i < cell->count; ++i) RT_LEAF(ctx, ctx->frozen2_grid_list[cell->first + i], ray, hit);\n"
    "#if RT_ANY_HIT\n"
    "        if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;\n"
    "#endif\n"
    "    }\n"
    "}\n";

static const rt_param kParams[] = {
    {"cells", "Cells", "cells along each axis", RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 64, 4, NULL}};
static const rt_slot kSlots[] = {{"frozen2_grid_heads", "frozen2_grid_head", sizeof(frozen2_grid_head), 0},
                                 {"frozen2_grid_cells", "frozen2_grid_cell", sizeof(frozen2_grid_cell), 0},
                                 {"frozen2_grid_list", "uint", sizeof(rt_u32), 0},
                                 {"frozen2_grid_bounds", NULL, sizeof(frozen2_grid_bounds), RT_SLOT_HOST_ONLY}};
static const rt_accel kAccel = {sizeof(rt_accel),
                                RT_KERNEL_CONTRACT,
                                sizeof kSlots / sizeof kSlots[0],
                                sizeof(rt_slot),
                                kSlots,
                                {"frozen2_grid_types.h", kTypes},
                                {"frozen2_grid.cl", kTraverse},
                                build,
                                levels,
                                NULL,
                                NULL,
                                NULL,
                                0,
                                0,
                                0,
                                RT_RAY_COST_LINEAR};
static const rt_extension kExtensions[] = {{"org.example.nothing", 1, 0, NULL}, {NULL, 0, 0, NULL}};
const rt_plugin rt_plugin_v1 = {RT_ABI_VERSION,
                                sizeof(rt_plugin),
                                RT_TYPES_DIGEST,
                                sizeof kParams / sizeof kParams[0],
                                "frozen2_grid",
                                "A grid of ABI 2",
                                "1.0.0",
                                NULL,
                                kParams,
                                &kAccel,
                                NULL,
                                kExtensions,
                                sizeof(rt_param),
                                sizeof(rt_extension)};
