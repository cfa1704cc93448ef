/* leaf_shape.h -- ray/shape test on lanes: takes the rays to the shape's space and calls its plugin's function. A template, see
 * CONTRACT.md.
 *
 * Only lanes that enter the shape's box in the world matter. The plugin gets rays that start where they enter it: there, far rays
 * have the precision of near ones.
 *
 * Plugins give the nearest hit. All hits are found by asking again behind each, until there is none. A test that is not exact may find
 * the same place again just behind it: 1e-6 of the box's diagonal behind, one ray in 20,000 met a torus five times, and 1e-7 behind,
 * twelve did. So the next question starts 1 / 16384 of the diagonal farther on, and hits of one shape that are nearer to each other
 * count as one. */
RT_INLINE void RT_FN(rt_hit_shape)(const rt_ctx *ctx, const global rt_packed_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
{
    vfloat entry;
    const vmask enters = rt_enter_bounds(rt_vfloat(leaf->a[0]), rt_vfloat(leaf->a[1]), rt_vfloat(leaf->a[2]), rt_vfloat(leaf->b[0]),
                                         rt_vfloat(leaf->b[1]), rt_vfloat(leaf->b[2]), r, h, &entry) &
                         RT_MASK(h->t >= rt_vfloat(0.0f));
    const uint active = rt_bits(enters);
    if (active == 0u) return;
    const global rt_shape *shape = ctx->shapes + RT_REF_INDEX(leaf->ref);
    const global float *m = shape->object_from_world;
    entry = rt_select(enters, entry, rt_vfloat(0.0f));
    const vfloat x = fma(entry, r->dx, r->ox), y = fma(entry, r->dy, r->oy), z = fma(entry, r->dz, r->oz);
    rt_shape_rays inner;
    inner.origin = rt_vec_of(fma(rt_vfloat(m[0]), x, fma(rt_vfloat(m[1]), y, fma(rt_vfloat(m[2]), z, rt_vfloat(m[3])))),
                             fma(rt_vfloat(m[4]), x, fma(rt_vfloat(m[5]), y, fma(rt_vfloat(m[6]), z, rt_vfloat(m[7])))),
                             fma(rt_vfloat(m[8]), x, fma(rt_vfloat(m[9]), y, fma(rt_vfloat(m[10]), z, rt_vfloat(m[11])))));
    inner.direction = rt_vec_of(fma(rt_vfloat(m[0]), r->dx, fma(rt_vfloat(m[1]), r->dy, rt_vfloat(m[2]) * r->dz)),
                                fma(rt_vfloat(m[4]), r->dx, fma(rt_vfloat(m[5]), r->dy, rt_vfloat(m[6]) * r->dz)),
                                fma(rt_vfloat(m[8]), r->dx, fma(rt_vfloat(m[9]), r->dy, rt_vfloat(m[10]) * r->dz)));
    inner.t_min = r->t_min - entry; /* the direction keeps its length, so distances mean the same in both spaces */
#ifdef RT_ALL_HITS
    inner.t_max = RT_INFINITY; /* a list's length must not change what a test computes */
    const rt_vec box = rt_splat(leaf->b[0] - leaf->a[0], leaf->b[1] - leaf->a[1], leaf->b[2] - leaf->a[2]);
    const vfloat step = sqrt(rt_dot(box, box) / fma(r->dx, r->dx, fma(r->dy, r->dy, r->dz * r->dz))) * rt_vfloat(1.0f / 16384.0f);
    vmask asking = enters;
    while (rt_any(asking)) {
        vfloat at_u = rt_vfloat(0.0f), at_v = at_u;
        const vfloat found = rt_shape_hit(ctx, shape, &inner, rt_bits(asking), &at_u, &at_v);
        asking &= RT_MASK(found >= inner.t_min) & RT_MASK(found < RT_INFINITY) & RT_MASK(found + entry <= h->t);
        const vfloat found_t = rt_max(found + entry, r->t_min), nothing = rt_vfloat(0.0f);
        const vmask wanted = asking & rt_closer(r, h, found_t, leaf->prim);
        if (rt_any(wanted)) RT_FN(rt_record)(h, wanted, found_t, at_u, at_v, nothing, nothing, nothing, (int)at, leaf->prim);
        const vfloat next = found + step;
        asking &= RT_MASK(next > found); /* else the step is lost in rounding, and the question would be the same */
        inner.t_min = rt_select(asking, next, inner.t_min);
    }
#else
    inner.t_max = h->t - entry;
    vfloat u = rt_vfloat(0.0f), v = u;
    const vfloat inside = rt_shape_hit(ctx, shape, &inner, active, &u, &v);
    const vfloat t = rt_max(inside + entry, r->t_min);
    const vmask closer = enters & RT_MASK(inside >= inner.t_min) & RT_MASK(inside < RT_INFINITY) & rt_closer(r, h, t, leaf->prim);
    if (!rt_any(closer)) return;
    const vfloat zero = rt_vfloat(0.0f);
    RT_FN(rt_record)(h, closer, t, u, v, zero, zero, zero, (int)at, leaf->prim);
#endif
}
