/* cwbvh.cl -- one ray against eight boxes of a byte a plane (RT_LANES 1), or a packet of rays against one box after the other.
 *
 * Made for GPUs and trees that outgrow their caches: a node is 80 bytes, five loads of 16. A turn of the loop is one item of
 * each ray, a node or two triangles, fetched before anything is computed, as in bvh4. Triangles that were met come before
 * nodes: bits in a register, never on the stack. Of the nodes the nearest goes first, and what is left of the eight takes one
 * place on the stack together, with the least distance at which one of them is entered; they follow by the signs of the
 * direction (Ylitie, Karras, Laine 2017). By the signs alone a third more nodes are visited by camera rays, 8 % more by
 * diffuse ones.
 *
 * 80 registers on an H200, so 24 warps a multiprocessor; 8 bytes of stack a level of the tree. Of bvh4's speed there it has
 * 0.74 to 0.86 with 871 k triangles and 0.82 to 0.93 with 102 M, for half the bytes fetched and 12 bytes a triangle less
 * (docs/performance.md): a node takes twice as long as one of four children. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
#if RT_LANES == 1
    ulong stack[CWBVH_DEPTH]; /* CWBVH_LEFT */
    uint top = 0, at = root;
    uint first = 0, row = 0, waiting = 0; /* primitives that were met: bits of `row`, which stand from `first` on */
    float from = 0.0f;                    /* where `at` is entered */
#if RT_ANY_HIT
#define CWBVH_FIRST(bits) ((bits) & -(bits)) /* order is worth nothing */
#else
    const cwbvh_order order = cwbvh_order_of(ray);
#define CWBVH_FIRST(bits) cwbvh_pick(&order, bits)
#endif
    for (;;) {
        float4 a, b, c, d, e, f;
        uint second = 0, two = 0;
        const uint is_leaf = waiting != 0u;
        uint item = at;
        if (is_leaf) {
            uint bit = waiting & -waiting;
            waiting ^= bit;
            item = first + CWBVH_RANK(row, bit);
            two = waiting != 0u;
            bit = waiting & -waiting;
            waiting ^= bit;
            second = first + CWBVH_RANK(row, bit);
#if RT_TRIANGLES_ONLY
            const global float4 *rows = (const global float4 *)(ctx->leaves + item);
            a = rows[0];
            b = rows[1];
            c = rows[2];
            if (two) {
                rows = (const global float4 *)(ctx->leaves + second);
                d = rows[0];
                e = rows[1];
                f = rows[2];
            }
#endif
        } else {
#if !RT_ANY_HIT
            if (from > hit->t) item = CWBVH_DONE;
#endif
            while (item == CWBVH_DONE) {
                if (top == 0u) return;
                const ulong entry = stack[top - 1u];
                uint left = (uint)(entry >> 32);
#if !RT_ANY_HIT
                if (as_float(left & 0xFFFF0000u) > hit->t) {
                    --top;
                    continue;
                }
#endif
                const uint bit = CWBVH_FIRST(left & 0xFFu);
                item = (uint)entry + CWBVH_RANK(left >> 8 & 0xFFu, bit);
                left ^= bit;
                if ((left & 0xFFu) == 0u)
                    --top;
                else
                    stack[top - 1u] = CWBVH_LEFT((uint)entry, left);
            }
            const global float4 *rows = (const global float4 *)(ctx->cwbvh_nodes + item);
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
            if (two) {
                const rt_loaded_prim other = {d, e, f};
                RT_LOADED_PRIM(ctx, &other, second, ray, hit);
            }
#else
            RT_LEAF(ctx, item, ray, hit);
            if (two) RT_LEAF(ctx, second, ray, hit);
#endif
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
            continue;
        }
        RT_COUNT_VISIT(hit, 1u);
        float4 in0, in1;
        const uint met = cwbvh_enter(ray, hit->t, a, c, d, e, &in0, &in1);
        const uint cells = as_uint(a.s3), base = as_uint(b.s0), inner = cells >> 24;
        first = as_uint(b.s1);
        row = as_uint(b.s2);
        waiting = cwbvh_spread(met) & row;
        uint left = met & inner;
        at = CWBVH_DONE;
        if (left != 0u) {
#if RT_ANY_HIT
            const uint bit = left & -left, second_from = 0u;
#else
            uint second_from;
            const uint nearest = cwbvh_nearest(left, in0, in1, &second_from), bit = 1u << (nearest & 7u);
            from = as_float(nearest & ~7u);
#endif
            left ^= bit;
            at = base + CWBVH_RANK(inner, bit);
            if (left != 0u) {
                stack[top] = CWBVH_LEFT(base, left | inner << 8 | (second_from & 0xFFFF0000u));
                if (RT_STACK_OK(top + 1u, CWBVH_DEPTH, hit)) ++top;
            }
        }
    }
#undef CWBVH_FIRST
#else
    /* As bvh4's packets. */
    const uint far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u) | (ray->lo_z == 2u ? 4u : 0u);
    vfloat stack_t[CWBVH_STACK];
    uint stack_node[CWBVH_STACK], stack_count[CWBVH_STACK]; /* 0: a node, else primitives from that one on */
    uint top = 0, at = root, count = 0;
    uint inside = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); /* lanes in the node, for counting programs */
    for (;;) {
        if (count != 0u) {
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, at + i, ray, hit);
#if RT_ANY_HIT
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, inside);
            const global cwbvh_node *node = ctx->cwbvh_nodes + at;
            const cwbvh_grid grid = cwbvh_make_grid(node, ray);
            const uint row = node->primitives, inner = CWBVH_INNER(node);
            for (uint i = 0; i < 8u; ++i) {
                const uint slot = i ^ far_first, primitives = row >> 4u * slot & 15u;
                if (primitives == 0u && (inner >> slot & 1u) == 0u) continue;
                vfloat entry;
                const vmask in = cwbvh_enter_slot(node, &grid, slot, ray, hit, &entry);
                if (!rt_any(in)) continue;
                stack_count[top] = popcount(primitives);
                stack_node[top] = primitives != 0u ? node->first_leaf + CWBVH_RANK(row, 1u << 4u * slot)
                                                   : node->first_child + CWBVH_RANK(inner, 1u << slot);
                stack_t[top] = rt_select(in, entry, RT_INFINITY);
                if (RT_STACK_OK(top + 1u, CWBVH_STACK, hit)) ++top;
            }
        }
        do {
            if (top == 0u) return;
            --top;
            inside = rt_bits(RT_MASK(stack_t[top] <= hit->t));
        } while (inside == 0u);
        at = stack_node[top];
        count = stack_count[top];
    }
#endif
}
