/* maps.h -- where on their textures surfaces are, how much of a texture a pixel sees, and what maps other than colours say.
 *
 * Smaller pictures are chosen by ray cones: Akenine-Moeller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray Cones",
 * Journal of Computer Graphics Techniques 10 (1). */
#ifndef RT_MAPS_H
#define RT_MAPS_H
#if RT_HAS_TEXTURES

/* A point of the picture itself. */
RT_INLINE rt_texture_point rt_sharp_point(vfloat u, vfloat v)
{
    rt_texture_point p;
    p.u = u;
    p.v = v;
#ifdef RT_HAS_MIPS
    p.level = rt_vfloat(0.0f);
#endif
    return p;
}

#ifdef RT_HAS_MIPS
/* The level at which a texel is as wide as the part of the texture that the pixel sees. size: of the texture, texels squared, times how
 * much a map stretches it. spread: rt_surface.spread. */
RT_INLINE vfloat rt_texture_level(vfloat spread, float size)
{
    /* Half the logarithm of the square: with a root PoCL 3.1 crashes while it compiles one lane of the iterative tracer for bvh2. */
    return rt_vfloat(0.5f) * rt_rough_log2(rt_max(spread * spread * rt_vfloat(size), rt_vfloat(1e-30f)));
}
#endif

/* Where a surface is on a texture that lies as the first set of coordinates says. */
RT_INLINE rt_texture_point rt_plain_point(const rt_ctx *ctx, uint texture, const rt_surface *s)
{
    rt_texture_point p = rt_sharp_point(s->tex_u, s->tex_v);
#ifdef RT_HAS_MIPS
    if (ctx->textures[texture].levels != 0u)
        p.level = rt_texture_level(s->spread, (float)ctx->textures[texture].width * (float)ctx->textures[texture].height);
#endif
    return p;
}

/* Sets what of its textures each lane sees. width: of the ray's cone where it meets the surface. incoming: its direction, of unit
 * length. */
#ifdef RT_HAS_MIPS
RT_INLINE void rt_spread_surface(rt_surface *s, rt_vec incoming, vfloat width)
{
    const vfloat across = width / rt_max(fabs(rt_dot(s->geometric, incoming)), rt_vfloat(1e-3f));
    s->spread *= across;
#ifdef RT_HAS_UVS2
    s->spread2 *= across;
#endif
}
/* The angle of the cone of a camera ray: that of a pixel in the middle of the picture. */
RT_INLINE float rt_pixel_angle(const constant rt_frame *frame)
{
    return 2.0f * frame->pixel_y * sqrt(frame->up[0] * frame->up[0] + frame->up[1] * frame->up[1] + frame->up[2] * frame->up[2]);
}
#endif

#ifdef RT_HAS_MAPS

/* The map that a material has for a use; null if it has none. */
RT_INLINE const global rt_map *rt_map_of(const rt_ctx *ctx, const global rt_material *m, uint use)
{
    const uint number = ctx->material_maps[(uint)(m - ctx->materials) * RT_MAP_USES + use];
    return number == RT_NONE ? 0 : ctx->maps + number;
}

RT_INLINE rt_texture_point rt_sharp_map_point(const global rt_map *map, const rt_surface *s)
{
    vfloat u = s->tex_u, v = s->tex_v;
#ifdef RT_HAS_UVS2
    if (map->set != 0u) u = s->tex_u2, v = s->tex_v2;
#endif
    const global float *m = map->matrix;
    return rt_sharp_point(fma(rt_vfloat(m[0]), u, fma(rt_vfloat(m[1]), v, rt_vfloat(m[2]))), fma(rt_vfloat(m[3]), u, fma(rt_vfloat(m[4]), v, rt_vfloat(m[5]))));
}

/* Where a surface is on the texture of a map. */
RT_INLINE rt_texture_point rt_map_point(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s)
{
    rt_texture_point p = rt_sharp_map_point(map, s);
#ifdef RT_HAS_MIPS
    const global rt_texture *texture = ctx->textures + map->texture;
    if (texture->levels != 0u) {
        const float stretch = fabs(map->matrix[0] * map->matrix[4] - map->matrix[1] * map->matrix[3]);
        vfloat spread = s->spread;
#ifdef RT_HAS_UVS2
        if (map->set != 0u) spread = s->spread2;
#endif
        p.level = rt_texture_level(spread, stretch * (float)texture->width * (float)texture->height);
    }
#endif
    return p;
}

/* The colour of a map; white without a map. */
RT_INLINE rt_vec rt_sample_map(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s, vmask lanes)
{
    if (!map) return rt_splat(1.0f, 1.0f, 1.0f);
    const rt_texture_point point = rt_map_point(ctx, map, s);
    return rt_sample_texture(ctx, map->texture, lanes, &point);
}

/* A channel of a map; 1 without a map. */
RT_INLINE vfloat rt_sample_map_channel(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s, vmask lanes, int channel)
{
    if (!map) return rt_vfloat(1.0f);
    const rt_texture_point point = rt_map_point(ctx, map, s);
    return rt_sample_channel(ctx, map->texture, lanes, &point, channel);
}
/* The same of the picture itself. */
RT_INLINE vfloat rt_sharp_map_channel(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s, vmask lanes, int channel)
{
    if (!map) return rt_vfloat(1.0f);
    const rt_texture_point point = rt_sharp_map_point(map, s);
    return rt_sample_channel(ctx, map->texture, lanes, &point, channel);
}

/* The share of ambient light that arrives: glTF 2.0, section 3.9.3. */
RT_INLINE vfloat rt_occlusion(const rt_ctx *ctx, const global rt_material *m, const rt_surface *s, vmask lanes)
{
    const global rt_map *map = rt_map_of(ctx, m, RT_MAP_OCCLUSION);
    const vfloat one = rt_vfloat(1.0f);
    if (!map) return one;
    return fma(rt_vfloat(map->scale), rt_sample_map_channel(ctx, map, s, lanes, 0) - one, one);
}
#endif

#if defined(RT_HAS_TANGENTS) && defined(RT_HAS_MAPS)
/* The normal of a map in the frame of tangent, bitangent and normal; not of unit length. */
RT_INLINE rt_vec rt_mapped_normal(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s, vmask lanes)
{
    const rt_texture_point point = rt_map_point(ctx, map, s);
    const rt_vec color = rt_sample_texture(ctx, map->texture, lanes, &point);
    /* Along which coordinates of the surface the picture's right and upper directions lie: the columns of the inverse matrix. */
    const global float *m = map->matrix;
    const float side = m[0] * m[4] < m[1] * m[3] ? -1.0f : 1.0f;
    const float to_right = side / sqrt(max(m[4] * m[4] + m[3] * m[3], 1e-36f)), upwards = side / sqrt(max(m[1] * m[1] + m[0] * m[0], 1e-36f));
    const vfloat two = rt_vfloat(2.0f), one = rt_vfloat(1.0f), scale = rt_vfloat(map->scale);
    const vfloat x = scale * fma(two, color.x, -one), y = scale * fma(two, color.y, -one);
    return rt_vec_of(fma(rt_vfloat(m[4] * to_right), x, rt_vfloat(-m[1] * upwards) * y), fma(rt_vfloat(-m[3] * to_right), x, rt_vfloat(m[0] * upwards) * y),
                     fma(two, color.z, -one));
}

/* Applies maps of normals. In lanes with such a map it turns the shading normal. Returns these lanes. */
RT_INLINE vmask rt_map_normals(const rt_ctx *ctx, rt_surface *s, uint bits)
{
    vmask mapped = rt_vint(0);
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(s->material, bits); rt_next_group(&g, &id, &mine);) {
        const global rt_map *map = rt_map_of(ctx, ctx->materials + id, RT_MAP_NORMAL);
        if (!map) continue;
        const rt_vec n = rt_mapped_normal(ctx, map, s, mine);
        const rt_vec turned = rt_along(n.x, s->tangent, rt_along(n.y, s->bitangent, rt_scale(n.z, s->normal)));
        const vmask turns = mine & RT_MASK(rt_dot(s->tangent, s->tangent) > rt_vfloat(0.5f)) & RT_MASK(rt_dot(turned, turned) > rt_vfloat(1e-8f));
        s->normal = rt_choose(turns, rt_normalize(turned), s->normal);
        mapped |= turns;
    }
    return mapped;
}
#endif
#endif /* RT_HAS_TEXTURES */

#ifdef RT_HAS_TANGENTS
/* Turns the axes *x and *y, perpendicular to the unit vector `normal`, along tangent and bitangent where a surface has them. Behind the
 * surface both are reversed, as the normal is. */
RT_INLINE void rt_turn_frame(const rt_surface *s, rt_vec normal, rt_vec *x, rt_vec *y)
{
    const vfloat zero = rt_vfloat(0.0f), side = rt_select(RT_MASK(rt_dot(normal, s->normal) < zero), rt_vfloat(-1.0f), rt_vfloat(1.0f));
    const rt_vec along = rt_sub(s->tangent, rt_scale(rt_dot(s->tangent, normal), normal));
    const vmask turns = RT_MASK(rt_dot(along, along) > rt_vfloat(1e-4f));
    const rt_vec tangent = rt_scale(side, rt_normalize(along)), across = rt_cross(normal, tangent);
    const vfloat handed = rt_select(RT_MASK(rt_dot(across, s->bitangent) * side < zero), rt_vfloat(-1.0f), rt_vfloat(1.0f));
    *x = rt_choose(turns, tangent, *x);
    *y = rt_choose(turns, rt_scale(handed, across), *y);
}
#endif

/* Completes a surface for shading. width: see rt_spread_surface(). */
#ifdef RT_HAS_MIPS
#define RT_SPREAD_SURFACE(frame, s, ray, width) rt_spread_surface(s, rt_vec_of((ray)->dx, (ray)->dy, (ray)->dz), width);
#else
#define RT_SPREAD_SURFACE(frame, s, ray, width)
#endif
#if defined(RT_HAS_TANGENTS) && defined(RT_HAS_MAPS)
#define RT_MAP_NORMALS(ctx, s, bits) rt_map_normals(ctx, s, bits);
#else
#define RT_MAP_NORMALS(ctx, s, bits)
#endif
/* For tracers other than `path`: the cone of a camera ray grows along the rays of mirrors and glass, too. Curved ones do not widen it. */
#ifdef RT_CARRIES_CONES
#define RT_WAY_OF(ray, t) ((ray)->travelled + (t))
#else
#define RT_WAY_OF(ray, t) (t)
#endif
#define RT_COMPLETE(ctx, frame, s, ray, hit, bits) \
    RT_SPREAD_SURFACE(frame, s, ray, RT_WAY_OF(ray, (hit)->t) * rt_vfloat(rt_pixel_angle(frame))) \
    RT_MAP_NORMALS(ctx, s, bits)

#endif
