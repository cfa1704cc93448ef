/* broken.cl -- a binary BVH without any optimisation. The builder defines one BROKEN_... at most; without it the traversal is
 * right. */
#ifdef BROKEN_SLABS
/* A slab test of one's own. Without another define it is a textbook's: right but for the slack that rounding needs. */
RT_INLINE vmask RT_CAT(RT_TRAVERSE, _slabs)(const global float *box, const rt_rays *r, const rt_hits *h, vfloat *entry)
{
    const vfloat d[3] = {r->dx, r->dy, r->dz}, o[3] = {r->ox, r->oy, r->oz}, i[3] = {r->ix, r->iy, r->iz};
    vfloat in = r->t_min, out = h->t;
    for (int k = 0; k < 3; ++k) {
        vfloat lo = rt_vfloat(box[k]), hi = rt_vfloat(box[k + 3]), scale = i[k];
#ifdef BROKEN_ROUNDS_BOXES
        lo = floor(lo * rt_vfloat(1024.0f) + rt_vfloat(0.5f)) / rt_vfloat(1024.0f);
        hi = floor(hi * rt_vfloat(1024.0f) + rt_vfloat(0.5f)) / rt_vfloat(1024.0f);
#endif
#ifdef BROKEN_DIVIDES
        scale = rt_vfloat(1.0f) / d[k]; /* infinity; and 0 * infinity on a plane */
#endif
        const vfloat a = (lo - o[k]) * scale, b = (hi - o[k]) * scale;
#ifdef BROKEN_SIGN_OF_D
        const vmask negative = RT_MASK(d[k] < rt_vfloat(0.0f)); /* -0 is not below 0, but its reciprocal is */
        in = rt_max(in, rt_select(negative, b, a)), out = rt_min(out, rt_select(negative, a, b) * RT_WIDE);
#elif defined(BROKEN_ROUNDS_BOXES)
        in = rt_max(in, rt_min(a, b) * (1.0f - 4e-7f)), out = rt_min(out, rt_max(a, b) * RT_WIDE);
#else
        in = rt_max(rt_min(a, b), in), out = rt_min(rt_max(a, b), out);
#endif
    }
    *entry = in;
#ifdef BROKEN_STRICT
    return RT_MASK(in < out);
#else
    return RT_MASK(in <= out);
#endif
}
#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    uint stack[BROKEN_STACK];
    uint top = 0, ref = root;
#ifdef BROKEN_GIVES_UP
    uint steps_left = 100u;
#endif
#ifdef BROKEN_GIVES_UP_LATE
    uint steps_left = 1000u;
#endif
#if defined(BROKEN_ANY_FORGETS_T_MAX) && RT_ANY_HIT
    hit->t = rt_select(RT_MASK(hit->t >= rt_vfloat(0.0f)), RT_INFINITY, hit->t);
#endif
    for (;;) {
        const global broken_node *node = ctx->broken_nodes + ref;
        vfloat entry;
#ifdef BROKEN_NEVER_INCOHERENT
        /* Takes the near planes of the first lane's octant for all lanes. */
        const global float *box = node->box;
        const uint x = rt_bits(rt_negative(ray->ix)) & 1u ? 3u : 0u, y = rt_bits(rt_negative(ray->iy)) & 1u ? 4u : 1u,
                   z = rt_bits(rt_negative(ray->iz)) & 1u ? 5u : 2u;
        uint inside = rt_bits(rt_enter_planes(rt_vfloat(box[x]), rt_vfloat(box[y]), rt_vfloat(box[z]), rt_vfloat(box[3u - x]),
                                              rt_vfloat(box[5u - y]), rt_vfloat(box[7u - z]), ray, hit, &entry));
#else
        uint inside = rt_bits(rt_enter_box(node->box, ray, hit, &entry));
#endif
#ifdef BROKEN_SLABS
        inside = rt_bits(RT_CAT(RT_TRAVERSE, _slabs)(node->box, ray, hit, &entry));
#endif
#if defined(BROKEN_CULLS_EAGERLY) || (BROKEN_CHOICE && RT_LANES > 1)
        inside &= rt_bits(RT_MASK(entry <= hit->t * rt_vfloat(0.999f)));
#endif
#ifdef BROKEN_CULLS_CLOSELY
        inside &= rt_bits(RT_MASK(entry <= hit->t * rt_vfloat(0.9999f)));
#endif
#ifdef BROKEN_CULLS_LEAVES
        if (node->count > 0u) inside &= rt_bits(RT_MASK(entry <= hit->t * rt_vfloat(0.9995f)));
#endif
#ifdef BROKEN_NOT_FAR
        inside &= rt_bits(RT_MASK(entry < rt_vfloat(2e4f)));
#endif
#ifdef BROKEN_ENDS_AT_A_MILLION
        inside &= rt_bits(RT_MASK(entry < rt_vfloat(1e6f)));
#endif
#ifdef BROKEN_NOT_INSIDE
        if (node->count > 0u) inside &= rt_bits(RT_MASK(entry > ray->t_min)); /* leaves that hold the origin */
#endif
#if defined(BROKEN_GIVES_UP) || defined(BROKEN_GIVES_UP_LATE)
        if (steps_left-- == 0u) return;
#endif
#if defined(BROKEN_LANES_16_ANY) && RT_LANES == 16 && RT_ANY_HIT
        inside &= 0x7fffu;
#endif
#ifdef BROKEN_OCTANT
        /* A wrong sign: this octant's rays take the far side for the near one. */
        inside &= ~rt_bits(rt_negative(ray->ix) & ~rt_negative(ray->iy) & rt_negative(ray->iz) & RT_MASK(entry > rt_vfloat(4.0f)));
#endif
#ifdef BROKEN_AXIS
        inside &= ~rt_bits(RT_MASK(ray->dx == rt_vfloat(0.0f)) & RT_MASK(entry > rt_vfloat(1.0f)));
#endif
#ifdef BROKEN_PLANES
        /* 0 * infinity: a ray within a face of the box misses it. */
        inside &= ~rt_bits(RT_MASK(ray->dx == rt_vfloat(0.0f)) & (RT_MASK(ray->ox == rt_vfloat(node->box[0])) | RT_MASK(ray->ox == rt_vfloat(node->box[3]))));
#endif
#ifdef BROKEN_FIRST_LANE
        if (node->count == 0u) inside &= 1u;
#endif
#if defined(BROKEN_LANES_8) && RT_LANES == 8
        inside &= 0x7fu;
#endif
        RT_COUNT_VISIT(hit, inside);
#ifdef BROKEN_READS_PAST_EMPTY
        if (node->count == BROKEN_EMPTY && node[1].count == 77u) return;
#endif
        if (inside != 0u && node->count != BROKEN_EMPTY) {
            if (node->count == 0u) {
                stack[top] = node->first + 1u;
#if defined(BROKEN_UNASKED) || (defined(BROKEN_UNASKED_ANY) && RT_ANY_HIT) || (defined(BROKEN_UNASKED_MESH) && RT_TRIANGLES_ONLY)
                ++top;
#else
#ifdef BROKEN_UNASKED_DEEP
                if (top >= 3u)
                    ++top;
                else
#endif
#ifdef BROKEN_UNASKED_FROM_8
                if (top >= 8u)
                    ++top;
                else
#endif
#ifdef BROKEN_UNASKED_ODD
                if (top & 1u)
                    ++top;
                else
#endif
                if (RT_STACK_OK(top + 1u, BROKEN_STACK, hit)) ++top;
#endif
                ref = node->first;
#ifdef BROKEN_DEVICE_LOOP
                if (top == 3u) --top, ref = root; /* begins anew, for ever */
#endif
                continue;
            }
            for (uint i = 0; i < node->count; ++i) {
#ifdef BROKEN_IGNORES_TRANSFORM
                const global rt_packed_prim *leaf = ctx->leaves + node->first + i;
                if (RT_REF_KIND(leaf->ref) == RT_REF_INSTANCE) {
                    if (top + 1u < BROKEN_STACK) stack[top++] = ctx->instances[RT_REF_INDEX(leaf->ref)].root;
                    continue;
                }
#endif
#ifdef BROKEN_SKIPS_EIGHTH
                if (i == 7u) continue;
#endif
#ifdef BROKEN_CUT_POSITIONS
                RT_LEAF(ctx, (node->first + i) & 0xffffu, ray, hit);
#elif defined(BROKEN_OWN_TEST) && RT_TRIANGLES_ONLY
                RT_FN(rt_hit_triangle)(ctx->leaves + node->first + i, node->first + i, ray, hit); /* not counted */
#else
                RT_LEAF(ctx, node->first + i, ray, hit);
#endif
            }
#ifdef BROKEN_WRITES_T
            hit->t *= rt_vfloat(0.9f);
#endif
#ifdef BROKEN_STOPS_AT_FIRST_LEAF
            if (rt_any(RT_MASK(hit->prim >= rt_vint(0)))) return;
#endif
#if defined(BROKEN_ALL_STOPS) && defined(RT_ALL_HITS)
            if (rt_any(RT_MASK(hit->list->prim[0] >= rt_vint(0)))) return;
#endif
#if RT_ANY_HIT
#ifdef BROKEN_ANY_RETURNS_EARLY
            if (rt_any(RT_MASK(hit->t < rt_vfloat(0.0f)))) return;
#else
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
#endif
        }
#ifdef BROKEN_FORGETS_DEFERRED
        if (top > 3u) --top;
#endif
        if (top == 0u) return;
        ref = stack[--top];
#ifdef BROKEN_READS_BEYOND_SLOT
        if (ctx->broken_nodes[ref + BROKEN_NODES].count == 77u) return;
#endif
    }
}
