/* spheres.cl -- trees of bounding spheres, without a stack: nodes are visited in their depth-first order, and a sphere that no lane
 * enters is skipped with all that is in it. Nearer ones do not come first.
 *
 * A lane enters where the centre is nearer to its line than the radius. That distance is that of a point from a line, not a
 * discriminant, which cancels for origins far away (Haines et al. 2019, Precision Improvements for Ray/Sphere
 * Intersection). The vectors involved are off by a few ulp of |l| = |centre - origin| in all; 16 ulp of it widen the sphere, so
 * that rounding never loses a lane. Along the line the diameter is taken for the chord: a square root less, a few visits more. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const vfloat slack = rt_vfloat(1.9073486e-6f);
    const vfloat inv_dd = rt_vfloat(1.0f) / fma(ray->dx, ray->dx, fma(ray->dy, ray->dy, ray->dz * ray->dz));
    const vfloat inv_d = sqrt(inv_dd) * (rt_vfloat(1.0f) + slack);
    const uint end = ctx->spheres_nodes[root].skip;
    for (uint at = root + 1u; at < end;) {
        const global spheres_node *node = ctx->spheres_nodes + at;
        const vfloat lx = rt_vfloat(node->center[0]) - ray->ox;
        const vfloat ly = rt_vfloat(node->center[1]) - ray->oy;
        const vfloat lz = rt_vfloat(node->center[2]) - ray->oz;
        const vfloat middle = fma(lx, ray->dx, fma(ly, ray->dy, lz * ray->dz)) * inv_dd;
        const vfloat vx = fma(-middle, ray->dx, lx), vy = fma(-middle, ray->dy, ly), vz = fma(-middle, ray->dz, lz);
        const vfloat distance2 = fma(vx, vx, fma(vy, vy, vz * vz));
        const vfloat radius = fma(fabs(lx) + fabs(ly) + fabs(lz), slack, rt_vfloat(node->radius));
        const vfloat half_chord = radius * inv_d;
        const vfloat in = rt_max(middle - half_chord, ray->t_min), out = rt_min(middle + half_chord, hit->t);
        /* What overflowed into NaN enters. */
        const uint inside = rt_bits(RT_MASK(in <= out) & ~RT_MASK(distance2 > radius * radius));
        RT_COUNT_VISIT(hit, inside);
        if (inside == 0u) {
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
