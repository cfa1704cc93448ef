/* sphere.h -- ray/sphere test on lanes.
 *
 * Haines, Guenther, Akenine-Moeller 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7. The
 * discriminant comes from the squared distance between the centre and the ray's line. The textbook's b^2 - 4ac cancels for far
 * or small spheres. A ray that starts inside hits the far side. A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_hit_sphere)(const global rt_packed_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    const float radius = leaf->b[0];
    const vfloat fx = r->ox - rt_vfloat(leaf->a[0]), fy = r->oy - rt_vfloat(leaf->a[1]), fz = r->oz - rt_vfloat(leaf->a[2]);
    const vfloat a = fma(r->dx, r->dx, fma(r->dy, r->dy, r->dz * r->dz));
    const vfloat b = -fma(fx, r->dx, fma(fy, r->dy, fz * r->dz)); /* minus half of the textbook's b */
    const vfloat along = b / a;
    const vfloat lx = fma(along, r->dx, fx), ly = fma(along, r->dy, fy), lz = fma(along, r->dz, fz);
    const vfloat room = rt_vfloat(radius * radius) - fma(lx, lx, fma(ly, ly, lz * lz));
    const vfloat zero = rt_vfloat(0.0f);
    const vmask meets = RT_MASK(room >= zero) & RT_MASK(h->t >= zero);
    if (!rt_any(meets)) return;

    const vfloat root = sqrt(rt_max(room, zero) * a);
    const vfloat q = b + copysign(root, b); /* both have the same sign, so nothing cancels */
    const vfloat c = fma(fx, fx, fma(fy, fy, fz * fz)) - rt_vfloat(radius * radius);
    const vfloat t_a = rt_select(RT_MASK(q != zero), c / q, zero), t_b = q / a;
    const vfloat t_near = rt_min(t_a, t_b), t_far = rt_max(t_a, t_b);
#ifdef RT_ALL_HITS /* both sides are hits */
    const vmask enters = meets & RT_MASK(t_near > zero) & rt_closer(r, h, t_near, leaf->prim);
    if (rt_any(enters)) RT_FN(rt_record)(h, enters, t_near, zero, zero, zero, zero, zero, (int)at, leaf->prim);
    const vfloat t = t_far;
#else
    const vfloat t = rt_select(RT_MASK(t_near >= r->t_min) & RT_MASK(t_near > zero), t_near, t_far);
#endif
    const vmask closer = meets & RT_MASK(t > zero) & rt_closer(r, h, t, leaf->prim);
    if (!rt_any(closer)) return;
    RT_FN(rt_record)(h, closer, t, zero, zero, fma(t, r->dx, fx), fma(t, r->dy, fy), fma(t, r->dz, fz), (int)at, leaf->prim);
}
