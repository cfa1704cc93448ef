/* spheres.cl -- trees of bounding spheres, without a stack: nodes are visited in their depth-first order, and a sphere that no lane
 * enters is skipped with all that is in it. Nearer ones do not come first, as in the thesis. */

#ifndef SPHERES_ENTER /* this file is read several times */
#define SPHERES_ENTER
/* Which lanes may meet something in the sphere before their nearest hit. By the distance of the centre from the line, not by a
 * discriminant, which cancels for origins far away (Haines et al. 2019, Precision Improvements for Ray/Sphere Intersection).
 * Along the line the sphere's diameter is taken for the chord: a square root less, a few spheres more. */
RT_INLINE vmask spheres_enter(const global spheres_node *node, const rt_rays *r, const rt_hits *h, vfloat inv_dd, vfloat inv_d)
{
    const vfloat lx = rt_vfloat(node->center[0]) - r->ox;
    const vfloat ly = rt_vfloat(node->center[1]) - r->oy;
    const vfloat lz = rt_vfloat(node->center[2]) - r->oz;
    const vfloat middle = fma(lx, r->dx, fma(ly, r->dy, lz * r->dz)) * inv_dd;
    const vfloat vx = fma(-middle, r->dx, lx), vy = fma(-middle, r->dy, ly), vz = fma(-middle, r->dz, lz);
    const vfloat distance2 = fma(vx, vx, fma(vy, vy, vz * vz));
    /* l, middle and v are off by a few ulp of |l| in all: 16 of them widen the sphere, so rounding never loses a lane. */
    const vfloat radius = fma(fabs(lx) + fabs(ly) + fabs(lz), rt_vfloat(32.0f * RT_EPS), rt_vfloat(node->radius));
    const vfloat half_chord = radius * inv_d;
    const vfloat in = rt_max(middle - half_chord, r->t_min), out = rt_min(middle + half_chord, h->t);
    return RT_MASK(in <= out) & ~RT_MASK(distance2 > radius * radius);
}
#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const vfloat inv_dd = rt_vfloat(1.0f) / fma(ray->dx, ray->dx, fma(ray->dy, ray->dy, ray->dz * ray->dz));
    const vfloat inv_d = sqrt(inv_dd) * rt_vfloat(1.0f + 4.0f * RT_EPS);
    const uint end = ctx->spheres_nodes[root].skip;
    for (uint at = root + 1u; at < end;) {
        const global spheres_node *node = ctx->spheres_nodes + at;
        RT_COUNT_STEP(hit);
        if (!rt_any(spheres_enter(node, ray, hit, inv_dd, inv_d))) {
            at = node->skip;
            continue;
        }
        ++at;
        const uint first = node->first, count = node->count;
        for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
        if (count != 0u && !rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
    }
}
