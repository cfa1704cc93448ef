/* point.h -- where rays meet surfaces, with normals on the side that they come from. */
#ifndef RT_POINT_H
#define RT_POINT_H

/* Where the ray of each lane meets a surface. Normals are on the side that the ray comes from. */
typedef struct rt_point {
    vmask hits;
    vmask leaving;    /* the ray comes from inside, so the normals were reversed */
    rt_vec at;        /* the hit point, world */
    rt_vec incoming;  /* unit direction of the ray */
    rt_vec geometric; /* unit geometric normal */
    rt_vec normal;    /* unit shading normal */
    vfloat cos_in;    /* cosine of the angle between normal and reversed ray, positive */
#ifdef RT_SPLITS_INCOHERENT
    vfloat area;      /* rt_surface.area */
#endif
#ifdef RT_CARRIES_CONES
    vfloat travelled; /* rt_rays.travelled of the rays that start here */
#endif
    vfloat outward;   /* rays that stay on this side start at: at + outward geometric */
    vfloat inward;    /* rays that go through the surface start at: at + inward geometric */
} rt_point;

RT_INLINE rt_point rt_point_of(const rt_rays *ray, const rt_surface *s, vmask hits)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_point p;
    p.hits = hits;
#ifdef RT_SPLITS_INCOHERENT
    p.area = s->area;
#endif
    p.incoming = rt_vec_of(ray->dx, ray->dy, ray->dz);
    p.at = s->at;
#ifdef RT_CARRIES_CONES
    p.travelled = ray->travelled + rt_dot(rt_sub(s->at, rt_vec_of(ray->ox, ray->oy, ray->oz)), p.incoming);
#endif
    p.leaving = RT_MASK(rt_dot(s->geometric, p.incoming) > zero);
    const vfloat side = rt_select(p.leaving, -one, one);
    p.geometric = rt_scale(side, s->geometric);
    p.normal = rt_scale(side, s->normal);
    /* At silhouettes an interpolated normal may point away from the viewer. Then the geometric normal replaces it. */
    p.normal = rt_choose(RT_MASK(rt_dot(p.normal, p.incoming) >= zero), p.geometric, p.normal);
#if defined(RT_HAS_TANGENTS) && defined(RT_HAS_MAPS)
    /* A mirror would lose what it sends below its own plane. The normal of a map bends until the mirrored ray stays above it: Keller et
     * al. 2017, "The Iray Light Transport Simulation and Rendering System". */
    const rt_vec turned = rt_scale(side, s->normal), back = rt_scale(-one, p.incoming);
    const rt_vec mirrored = rt_sub(rt_scale(2.0f * rt_dot(turned, back), turned), back);
    const vfloat least = rt_min(rt_vfloat(0.01f), 0.5f * rt_dot(back, p.geometric)), rise = rt_dot(mirrored, p.geometric);
    const rt_vec raised = rt_normalize(rt_along(least - rise, p.geometric, mirrored));
    const vmask bends = RT_MASK(rise < least) & RT_MASK(rt_dot(s->normal, s->unmapped) < rt_vfloat(0.9999f));
    p.normal = rt_choose(bends, rt_normalize(rt_add(back, raised)), p.normal);
#endif
    p.cos_in = rt_min(-rt_dot(p.normal, p.incoming), one);
    const vfloat height = side * s->height;
    p.outward = rt_max(s->error - height, zero);
    p.inward = -s->error - height;
    return p;
}

/* The share of its intensity that a light of RT_LIGHTS_POINTS has in a direction. cosine: to its axis; the others as in rt_light. */
RT_INLINE vfloat rt_intensity_share(vint kind, vfloat cosine, vfloat cos_inner, vfloat cos_outer)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    vfloat share = one;
    if (RT_MAY_SHINE(1u << RT_LIGHT_SPOT)) {
        /* KHR_lights_punctual: the square of a linear ramp between the cosines of both angles. */
        const vfloat ramp = clamp((cosine - cos_outer) / rt_max(cos_inner - cos_outer, rt_vfloat(1e-3f)), zero, one);
        share = rt_select(RT_MASK(kind == rt_vint((int)RT_LIGHT_SPOT)), ramp * ramp, share);
    }
    return share;
}

/* How the light of a point falls off: by the inverse square of the distance, and to nothing at its range, 0 if it has none
 * (KHR_lights_punctual). */
RT_INLINE vfloat rt_fall_off(vfloat squared, vfloat range)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), least = rt_vfloat(1e-30f);
    const vfloat share = squared / rt_max(range * range, least);
    return rt_select(RT_MASK(range > zero), clamp(fma(-share, share, one), zero, one), one) / rt_max(squared, least);
}

#endif
