/* cwbvh.cl -- traversal of a compressed tree of eight children a node: one ray against eight boxes of a byte a plane (RT_LANES
 * 1), or a packet of rays.
 *
 * Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs". Made for GPUs and
 * trees that outgrow their caches: a node is 80 bytes, five loads of 16. A step of the loop is a node or two triangles for each
 * ray, fetched before anything is computed, as in bvh4. Triangles of leaves that are entered come before nodes; they are bits
 * in a register and never on the stack. The nearest node is visited next. The other nodes of the eight share one stack entry
 * with the least of their entry distances, and are visited in the order of the signs of the direction. With that order alone
 * camera rays visit a third more nodes, diffuse rays 8 % more.
 *
 * Stack: 8 bytes a level of the tree. 80 registers on an H200, so 24 warps a multiprocessor. There it has 0.74 to 0.86 of
 * bvh4's speed with 871 k triangles and 0.82 to 0.93 with 102 M, for half the bytes fetched and 12 bytes a triangle less
 * (docs/how_it_works.md): a node takes twice as long as one of four children. */
#if RT_LANES == 1

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    ulong stack[CWBVH_DEPTH]; /* CWBVH_LEFT */
    uint top = 0, at = root;
    /* A row of primitives begins at `first`, in the order of the set bits of `row`. untested: the bits of those still to test. */
    uint first = 0, row = 0, untested = 0;
    float entry_t = 0.0f; /* the entry distance of `at` */
#if RT_ANY_HIT
#define CWBVH_FIRST(bits) ((bits) & -(bits)) /* order does not matter */
#else
    const cwbvh_order order = cwbvh_order_of(ray);
#define CWBVH_FIRST(bits) cwbvh_pick(&order, bits)
#endif
    for (;;) {
        float4 a, b, c, d, e, f;
        uint second = 0, has_second = 0;
        const uint is_leaf = untested != 0u;
        uint item = at;
        if (is_leaf) {
            uint bit = untested & -untested;
            untested ^= bit;
            item = first + CWBVH_RANK(row, bit);
            has_second = untested != 0u;
            bit = untested & -untested;
            untested ^= bit;
            second = first + CWBVH_RANK(row, bit);
#if RT_TRIANGLES_ONLY
            const global float4 *rows = (const global float4 *)(ctx->leaves + item);
            a = rows[0];
            b = rows[1];
            c = rows[2];
            if (has_second) {
                rows = (const global float4 *)(ctx->leaves + second);
                d = rows[0];
                e = rows[1];
                f = rows[2];
            }
#endif
        } else {
#if !RT_ANY_HIT
            if (entry_t > hit->t) item = CWBVH_DONE;
#endif
            while (item == CWBVH_DONE) {
                if (top == 0u) return;
                const ulong entry = stack[top - 1u];
                uint remaining = (uint)(entry >> 32);
#if !RT_ANY_HIT
                if (as_float(remaining & 0xFFFF0000u) > hit->t) {
                    --top;
                    continue;
                }
#endif
                const uint bit = CWBVH_FIRST(remaining & 0xFFu);
                item = (uint)entry + CWBVH_RANK(remaining >> 8 & 0xFFu, bit);
                remaining ^= bit;
                if ((remaining & 0xFFu) == 0u)
                    --top;
                else
                    stack[top - 1u] = CWBVH_REMAINING((uint)entry, remaining);
            }
            const global float4 *rows = (const global float4 *)RT_NODE(ray, ctx->cwbvh_nodes + item);
            a = rows[0];
            b = rows[1];
            c = rows[2];
            d = rows[3];
            e = rows[4];
        }
        if (is_leaf) {
#if RT_TRIANGLES_ONLY
            const rt_loaded_prim one = {a, b, c};
            RT_LOADED_PRIM(ctx, &one, item, ray, hit);
            if (has_second) {
                const rt_loaded_prim two = {d, e, f};
                RT_LOADED_PRIM(ctx, &two, second, ray, hit);
            }
#else
            RT_LEAF(ctx, item, ray, hit);
            if (has_second) RT_LEAF(ctx, second, ray, hit);
#endif
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
            continue;
        }
        RT_COUNT_VISIT(hit, 1u);
        RT_COUNT_BOXES(hit, 8u);
        float4 in0, in1;
        const uint entered = cwbvh_enter(ray, hit->t, a, c, d, e, &in0, &in1);
        const uint cells = as_uint(a.s3), base = as_uint(b.s0), inner = cells >> 24;
        first = as_uint(b.s1);
        row = as_uint(b.s2);
        untested = cwbvh_spread(entered) & row;
        uint remaining = entered & inner;
        at = CWBVH_DONE;
        if (remaining != 0u) {
#if RT_ANY_HIT
            const uint bit = remaining & -remaining, remaining_t = 0u;
#else
            uint remaining_t;
            const uint nearest = cwbvh_nearest(remaining, in0, in1, &remaining_t), bit = 1u << (nearest & 7u);
            entry_t = as_float(nearest & ~7u);
#endif
            remaining ^= bit;
            at = base + CWBVH_RANK(inner, bit);
            if (remaining != 0u) {
                stack[top] = CWBVH_REMAINING(base, remaining | inner << 8 | (remaining_t & 0xFFFF0000u));
                if (RT_STACK_OK(top + 1u, CWBVH_DEPTH, hit)) ++top;
            }
        }
    }
#undef CWBVH_FIRST
}

#else

#define RT_PACKET_STACK_SIZE CWBVH_STACK
#define RT_PACKET_RAYS uint
#include "cl/lanes/packet_traversal.h"

/* Pushes the children that are entered, by their slots. *far_first has the bits of the slot that is visited last. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _children)(const rt_ctx *ctx, uint ref, const rt_rays *ray, const uint *far_first, rt_hits *hit,
                                              rt_packet_stack *stack)
{
    const global cwbvh_node *node = ctx->cwbvh_nodes + ref;
    const cwbvh_grid grid = cwbvh_make_grid(node, ray);
    const uint row = node->primitives, inner = CWBVH_INNER(node);
    for (uint i = 0; i < 8u; ++i) {
        const uint slot = i ^ *far_first, primitives = row >> 4u * slot & 15u;
        if (primitives == 0u && (inner >> slot & 1u) == 0u) continue;
        RT_COUNT_BOXES(hit, 1u);
        vfloat entry;
        const vmask in = cwbvh_enter_slot(node, &grid, slot, ray, hit, &entry);
        if (!rt_any(in)) continue;
        const uint child = primitives != 0u
                               ? CWBVH_MAKE_LEAF(node->first_leaf + CWBVH_RANK(row, 1u << 4u * slot), popcount(primitives))
                               : node->first_child + CWBVH_RANK(inner, 1u << slot);
        rt_push_packet(stack, child, rt_select(in, entry, RT_INFINITY), hit);
    }
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const uint far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u) | (ray->lo_z == 2u ? 4u : 0u);
    RT_CAT(RT_TRAVERSE, _packet)(ctx, root, ray, &far_first, hit);
}
#undef RT_PACKET_STACK_SIZE
#undef RT_PACKET_RAYS
#endif
