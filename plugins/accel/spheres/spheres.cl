/* spheres.cl -- traversal of trees of bounding spheres. 32 bytes a node, no stack.
 *
 * Nodes are visited in depth-first order. A sphere that no lane enters is skipped with everything in it. Nearer spheres are not
 * visited first, which makes the traversal simple and slow.
 *
 * A ray enters a sphere if the centre is nearer to the ray's line than the radius. That distance is computed as that of a point
 * from a line, not as a discriminant, which cancels for origins far away (Haines, Guenther, Akenine-Moeller 2019, "Precision
 * Improvements for Ray/Sphere Intersection"). The vectors have errors of a few ulp of |l| = |centre - origin| in all. The
 * sphere is widened by 16 ulp of that, so rounding never loses a lane. Along the line the diameter stands for the chord, which
 * saves a square root and costs a few visits. */
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
        /* A distance that overflowed into NaN counts as entered. */
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
