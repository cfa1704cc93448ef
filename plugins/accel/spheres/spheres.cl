/* spheres.cl -- traversal of trees of bounding volumes. 32 bytes a node, 68 with axes; no stack.
 *
 * Nodes are visited in depth-first order. A volume that no lane enters is skipped with everything in it. Nearer volumes are not
 * visited first, which makes the traversal simple and slow. */

/* The lanes that enter the volume of a node before their nearest hit. inv_dd: 1 by the square of the direction's length. */
RT_INLINE vmask RT_CAT(RT_TRAVERSE, _enter)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit, vfloat inv_dd)
{
    const global float *volume = RT_NODE(ray, ctx->spheres_nodes + at)->volume;
#if SPHERES_VOLUME == SPHERES_BOX
    vfloat entry;
    return rt_enter_box(volume, ray, hit, &entry);
#else
    RT_COUNT_BOXES(hit, 1u);
    const vfloat slack = rt_vfloat(1.9073486e-6f);
    const vfloat lx = rt_vfloat(volume[0]) - ray->ox, ly = rt_vfloat(volume[1]) - ray->oy, lz = rt_vfloat(volume[2]) - ray->oz;
#if SPHERES_VOLUME == SPHERES_ORIENTED
    /* A slab test in the box's own axes. The place of the box along them, and how far the ray moves along them, have errors of a few
     * ulp of |l| = |center - origin| and of the box's size in all. The box is widened by 16 ulp of that. */
    const global float *axis = ctx->spheres_axes[at].axis;
    const vfloat wider = (fabs(lx) + fabs(ly) + fabs(lz) + rt_vfloat(volume[3] + volume[4] + volume[5])) * slack;
    vfloat in = ray->t_min, out = hit->t;
    for (uint k = 0; k < 3u; ++k, axis += 3) {
        const vfloat x = rt_vfloat(axis[0]), y = rt_vfloat(axis[1]), z = rt_vfloat(axis[2]);
        const vfloat middle = fma(x, lx, fma(y, ly, z * lz)), inverse = rt_slab_reciprocal(fma(x, ray->dx, fma(y, ray->dy, z * ray->dz)));
        const vfloat reach = rt_vfloat(volume[3u + k]) + wider;
        const vfloat low = (middle - reach) * inverse, high = (middle + reach) * inverse;
        in = rt_max(rt_min(low, high), in);
        out = rt_min(rt_max(low, high) * rt_vfloat(RT_WIDE), out);
    }
    return RT_MASK(in <= out);
#else
    /* A ray enters a sphere if the centre is nearer to the ray's line than the radius. That distance is computed as that of a
     * point from a line, not as a discriminant, which cancels for origins far away (Haines, Guenther, Akenine-Moeller 2019,
     * "Precision Improvements for Ray/Sphere Intersection"). The vectors have errors of a few ulp of |l| in all. The sphere is
     * widened by 16 ulp of that, so rounding never loses a lane. Along the line the diameter stands for the chord, which saves a
     * square root and costs a few visits. A distance that overflowed into NaN counts as entered. */
    const vfloat middle = fma(lx, ray->dx, fma(ly, ray->dy, lz * ray->dz)) * inv_dd;
    const vfloat vx = fma(-middle, ray->dx, lx), vy = fma(-middle, ray->dy, ly), vz = fma(-middle, ray->dz, lz);
    const vfloat distance2 = fma(vx, vx, fma(vy, vy, vz * vz));
    const vfloat radius = fma(fabs(lx) + fabs(ly) + fabs(lz), slack, rt_vfloat(volume[3]));
    const vfloat half_chord = radius * (sqrt(inv_dd) * (rt_vfloat(1.0f) + slack));
    const vfloat in = rt_max(middle - half_chord, ray->t_min), out = rt_min(middle + half_chord, hit->t);
    return RT_MASK(in <= out) & ~RT_MASK(distance2 > radius * radius);
#endif
#endif
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const vfloat inv_dd = rt_vfloat(1.0f) / fma(ray->dx, ray->dx, fma(ray->dy, ray->dy, ray->dz * ray->dz));
    const uint end = ctx->spheres_nodes[root].link;
    for (uint at = root + 1u; at < end;) {
        const uint inside = rt_bits(RT_CAT(RT_TRAVERSE, _enter)(ctx, at, ray, hit, inv_dd));
        RT_COUNT_VISIT(hit, inside);
        const uint link = ctx->spheres_nodes[at].link, count = ctx->spheres_nodes[at].count;
        if (inside == 0u) {
            at = count != 0u ? at + 1u : link;
            continue;
        }
        ++at;
        for (uint i = 0; i < count; ++i) RT_LEAF(ctx, link + i, ray, hit);
#if RT_ANY_HIT
        if (count != 0u && !rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
    }
}
