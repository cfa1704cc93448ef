/* surface.h -- computes what shading needs of a hit: the point, normals, texture coordinates, material, primitive number.
 *
 * The point is the ray's origin + t times its direction, so rounding puts it beside the surface. Both the distance from the surface
 * and a bound on all errors of rays that start there are computed from numbers near the point: they do not grow with the length of
 * the ray. After Pharr, Jakob, Humphreys 2016, Physically Based Rendering, section 3.9, Managing Rounding Error. */
#ifndef RT_SURFACE_H
#define RT_SURFACE_H

/* Scatter: stores lane l of `value` at buffer[lane l of `index`], for the lanes in `bits`. */
#define RT_FOR_LANES_STORE(buffer, index, value, bits)                                                                           \
    {                                                                                                                            \
        float store_values[RT_LANES];                                                                                            \
        int store_index[RT_LANES];                                                                                               \
        rt_store(value, store_values);                                                                                           \
        rt_store(index, store_index);                                                                                            \
        for (uint store_l = 0; store_l < RT_LANES; ++store_l)                                                                    \
            if ((bits) >> store_l & 1u) buffer[store_index[store_l]] = store_values[store_l];                                    \
    }

/* Whether hits of material `number` need the texture coordinates of a sphere. Computing them for all spheres took a twelfth of a
 * frame, because they need arc functions. */
#ifdef RT_AOV
#define RT_USES_UV(ctx, number) 1
#else
#ifdef RT_HAS_MAPS
#define RT_USES_UV(ctx, number) 1
#else
#define RT_USES_UV(ctx, number) ((ctx)->materials[number].texture != RT_NONE)
#endif
#endif

/* The error of a sum of products after n roundings is at most RT_GAMMA(n) times the sum of the absolute values of its terms. */
#define RT_GAMMA(n) ((n)*RT_EPS / (1.0f - (n)*RT_EPS))
/* Roundings in the height of a point above a plane or sphere: one in each difference to the anchor, three in the dot product, one
 * more in a sphere's radius. The height is computed twice: here, and by the primitive's own test of a ray that starts here. */
#define RT_HEIGHT_ERROR RT_GAMMA(10.0f)
/* Each coordinate of a ray's origin is rounded once: half an ulp, times the square root of 3 along a slanted normal. */
#define RT_ORIGIN_ERROR RT_GAMMA(2.0f)
/* Rays start at least this share of the largest coordinate above a surface. rt_prepare_for_boxes() widens boxes by 8 RT_EPS of the
 * origin's coordinate, so a ray that starts nearer to a flat box along the axes still enters it, and visits the leaf of its own
 * surface. Frames of rooms took 6 to 10 % longer for that on an H200. */
#define RT_BOX_CLEARANCE RT_GAMMA(12.0f)
/* A coordinate in an instance's object space is a sum of four terms: three roundings here, and three in the primitive's test. */
#define RT_PLACED_ERROR RT_GAMMA(7.0f)

typedef struct rt_surface {
    vmask hit;
    rt_vec at;           /* the point, world */
    vfloat height;       /* of `at` above the surface, along `geometric` */
    vfloat error;        /* a ray that starts farther than this from the surface does not meet it again by rounding */
    rt_vec geometric;    /* unit normal, world, on the primitive's own side */
    rt_vec normal;       /* unit shading normal, on the side of `geometric`; interpolated where there are vertex normals */
    vfloat tex_u, tex_v; /* (0,0) at the bottom left of a texture */
#ifdef RT_HAS_UVS2
    vfloat tex_u2, tex_v2; /* of the second set; of what is no triangle the same as the first */
#endif
#ifdef RT_HAS_MIPS
    vfloat spread;       /* how far tex_u and tex_v change along a length of 1; after rt_spread_surface() within what a pixel sees */
#ifdef RT_HAS_UVS2
    vfloat spread2;
#endif
#endif
#ifdef RT_HAS_TANGENTS
    rt_vec tangent, bitangent; /* of unit length and perpendicular to `unmapped`; where there are none, 0 */
    rt_vec unmapped;           /* `normal` before a map turned it */
#endif
#ifdef RT_HAS_COLORS
    rt_vec color;        /* of the vertices, linear; 1 where there are none */
#ifdef RT_HAS_CUTOUTS
    vfloat alpha;        /* likewise */
#endif
#endif
#ifdef RT_SPLITS_INCOHERENT
    vfloat area;         /* twice the triangle's area; infinite for other kinds of primitives */
#endif
    vint prim;           /* -1: nothing hit */
    vint material;
} rt_surface;

#if RT_HAS_INSTANCES || RT_HAS_SHAPES
/* Transforms a normal to the world by the transpose of m = object_from_world. The result is not of unit length. */
RT_INLINE rt_vec rt_world_normal(const global float *m, rt_vec n)
{
    return rt_vec_of(m[0] * n.x + m[4] * n.y + m[8] * n.z, m[1] * n.x + m[5] * n.y + m[9] * n.z, m[2] * n.x + m[6] * n.y + m[10] * n.z);
}

#if defined(RT_HAS_MIPS) || defined(RT_HAS_TANGENTS)
/* The inverse of the 3x3 part of m times its determinant, column after column. Returns the determinant. */
RT_INLINE float rt_inverse_columns(const global float *m, float *columns)
{
    for (uint i = 0; i < 3u; ++i) {
        const global float *a = m + 4u * ((i + 1u) % 3u), *b = m + 4u * ((i + 2u) % 3u);
        columns[3u * i] = fma(a[1], b[2], -(a[2] * b[1]));
        columns[3u * i + 1u] = fma(a[2], b[0], -(a[0] * b[2]));
        columns[3u * i + 2u] = fma(a[0], b[1], -(a[1] * b[0]));
    }
    return fma(m[0], columns[0], fma(m[1], columns[1], m[2] * columns[2]));
}
#endif

/* A row of object_from_world times the point p. *magnitude: the sum of the absolute values of the terms. */
RT_INLINE vfloat rt_place_row(const global float *row, rt_vec p, vfloat *magnitude)
{
    *magnitude = fma(rt_vfloat(fabs(row[0])), fabs(p.x), fma(rt_vfloat(fabs(row[1])), fabs(p.y),
                     fma(rt_vfloat(fabs(row[2])), fabs(p.z), rt_vfloat(fabs(row[3])))));
    return fma(rt_vfloat(row[0]), p.x, fma(rt_vfloat(row[1]), p.y, fma(rt_vfloat(row[2]), p.z, rt_vfloat(row[3]))));
}
#endif

#ifdef RT_HAS_MIPS
/* Twice the area of a triangle on its texture. */
RT_INLINE float rt_uv_area(const global float *uvs, const global rt_triangle *tri)
{
    const global float *a = uvs + 2ul * tri->v[0], *b = uvs + 2ul * tri->v[1], *c = uvs + 2ul * tri->v[2];
    return fabs(fma(b[0] - a[0], c[1] - a[1], -((b[1] - a[1]) * (c[0] - a[0]))));
}
#endif

#ifdef RT_HAS_TANGENTS
/* The tangents of a triangle's corners, in its plane and its own space: host/scene/tangents.hpp says how they are stored. Returns 1, or
 * -1 where the texture is mirrored. */
RT_INLINE float rt_load_tangents(const global rt_packed_prim *leaf, const global uint *stored, float *tangents)
{
    const float3 a = vload3(0, leaf->a), e = vload3(0, leaf->b) - a, f = vload3(0, leaf->c) - a;
    const float3 n = cross(e, f);
    const float3 x = e * rsqrt(max(dot(e, e), 1e-36f)), across = cross(n, e), y = across * rsqrt(max(dot(across, across), 1e-36f));
    for (uint i = 0; i < 3u; ++i) {
        const float along_x = (float)((int)(stored[i] << 16) >> 17), along_y = (float)((int)stored[i] >> 17);
        vstore3((x * along_x + y * along_y) * (1.0f / 16383.0f), i, tangents);
    }
    return (stored[0] & 1u) != 0u ? -1.0f : 1.0f;
}
#endif

/* sum |a_k| |b_k| */
RT_INLINE vfloat rt_absolute_dot(rt_vec a, rt_vec b) { return fma(fabs(a.x), fabs(b.x), fma(fabs(a.y), fabs(b.y), fabs(a.z * b.z))); }

#if RT_HAS_SHAPES
/* The surface of a shape at the points `at` of the world. The normal is that of the world and not of unit length; height and error
 * are multiples of its length. */
RT_INLINE rt_shape_surface rt_resolve_shape(const rt_ctx *ctx, const global rt_shape *shape, rt_vec at, const rt_hits *hit, uint bits,
                                            int wants_uv)
{
    rt_vec placed, magnitude;
    placed.x = rt_place_row(shape->object_from_world, at, &magnitude.x);
    placed.y = rt_place_row(shape->object_from_world + 4, at, &magnitude.y);
    placed.z = rt_place_row(shape->object_from_world + 8, at, &magnitude.z);
    rt_shape_surface s;
    s.error = rt_vfloat(shape->error);
    s.height = s.tex_u = s.tex_v = rt_vfloat(0.0f);
    s.normal = rt_splat(1.0f, 0.0f, 0.0f);
    s.wants_uv = wants_uv;
    rt_shape_surface_at(ctx, shape, placed, hit->u, hit->v, bits, &s);
    s.normal = rt_normalize(s.normal);
    s.error += RT_PLACED_ERROR * rt_absolute_dot(s.normal, magnitude);
    s.normal = rt_world_normal(shape->object_from_world, s.normal);
    return s;
}
#endif

/* Returns the surfaces at the hits of the lanes in `bits`. Lanes that hit the same primitive are handled together: neighbours
 * mostly do where triangles are large. */
RT_INLINE rt_surface rt_resolve(const rt_ctx *ctx, const rt_rays *ray, const rt_hits *hit, uint bits)
{
    const vfloat zero = rt_vfloat(0.0f);
    rt_surface s;
    s.prim = hit->prim;
    s.hit = RT_MASK(s.prim >= rt_vint(0));
    s.material = rt_vint(0);
    s.tex_u = s.tex_v = zero;
    /* A normal is as long as its triangle is large, squared: of a triangle of 1e-12 its square would be 0, of one of 1e10 infinite.
     * Times a power of two it is about 1 long, and no digit changes. */
    s.geometric = rt_vec_of(hit->nx, hit->ny, hit->nz);
    const vint exponent = rt_as_vint(rt_largest(rt_vec_of(fabs(hit->nx), fabs(hit->ny), fabs(hit->nz)))) & rt_vint(0x7f800000);
    s.geometric = rt_scale(rt_as_vfloat(rt_vint(0x7f000000) - rt_select(RT_MASK(exponent < rt_vint(0x7e800000)), exponent, rt_vint(0x7e800000))),
                           s.geometric);
    /* The point is nearer than the hit by the errors of t and of each coordinate, but not beyond the ray's origin. So it is also in
     * front of other surfaces that meet this one here. Otherwise rays from the floor beside a wall could start behind the wall. */
    const vfloat reach = rt_select(s.hit, hit->t, zero) * (1.0f - RT_GAMMA(4.0f));
    s.at = rt_along(reach, rt_vec_of(ray->dx, ray->dy, ray->dz), rt_vec_of(ray->ox, ray->oy, ray->oz));
    const vfloat coordinate = rt_largest(rt_vec_of(fabs(s.at.x), fabs(s.at.y), fabs(s.at.z)));
    const vfloat rounding = RT_ORIGIN_ERROR * coordinate;
    s.at = rt_sub(s.at, rt_vec_of(rt_max(rt_min(reach * ray->dx, rounding), -rounding), rt_max(rt_min(reach * ray->dy, rounding), -rounding),
                                  rt_max(rt_min(reach * ray->dz, rounding), -rounding)));
    rt_vec anchor = rt_vec_of(zero, zero, zero); /* a point of the plane; the centre of a sphere */
#if RT_HAS_PLANES
    vfloat plane_offset = zero;
#endif
#if RT_HAS_SPHERES
    vfloat radius = zero;
#endif
#if RT_HAS_SHAPES
    vmask shaped = rt_vint(0);
    vfloat shape_height = zero, shape_error = zero, shape_u = zero, shape_v = zero;
#endif
#if RT_HAS_NORMALS
    rt_vec normal[3] = {{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}}; /* of each corner */
#endif
#if RT_HAS_UVS
    vfloat corner_u[3] = {zero, zero, zero}, corner_v[3] = {zero, zero, zero};
#endif
#ifdef RT_HAS_COLORS
    rt_vec corner_color[3];
    for (uint i = 0; i < 3u; ++i) corner_color[i] = rt_splat(1.0f, 1.0f, 1.0f);
#ifdef RT_HAS_CUTOUTS
    vfloat corner_alpha[3] = {rt_vfloat(1.0f), rt_vfloat(1.0f), rt_vfloat(1.0f)};
#endif
#endif
#ifdef RT_HAS_UVS2
    vmask is_triangle = rt_vint(0);
    vfloat corner_u2[3] = {zero, zero, zero}, corner_v2[3] = {zero, zero, zero};
#endif
#ifdef RT_HAS_TANGENTS
    rt_vec tangent[3] = {{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}}; /* in the plane of the triangle */
    vfloat handed = rt_vfloat(1.0f);
    vmask of_sphere = rt_vint(0);
#endif
#ifdef RT_HAS_MIPS
    /* Twice the area of a triangle, in its own space and on its texture; of other surfaces what stands in the same relation. */
    const vfloat raw_length = sqrt(fma(hit->nx, hit->nx, fma(hit->ny, hit->ny, hit->nz * hit->nz)));
    vfloat area = rt_vfloat(1.0f), uv_area = zero;
#ifdef RT_HAS_UVS2
    vfloat uv_area2 = zero;
#endif
#endif
#if RT_HAS_TEXTURES
    vmask planar = rt_vint(0);
    uint round = 0;
#endif

#ifdef RT_SPLITS_INCOHERENT
    s.area = sqrt(rt_dot(s.geometric, s.geometric)) * rt_as_vfloat(exponent) * (RT_SCENE_SCALE * RT_SCENE_SCALE);
#endif

    int at;
    vmask mine;
    for (rt_groups g = rt_group_lanes(hit->leaf, bits & rt_bits(RT_MASK(hit->leaf != rt_vint(-1)))); rt_next_group(&g, &at, &mine);) {
#if RT_HAS_PLANES
        if (at < -1) {
            s.material = rt_select(mine, rt_vint((int)ctx->planes[-2 - at].material), s.material);
            plane_offset = rt_select(mine, rt_vfloat(ctx->planes[-2 - at].offset), plane_offset);
#ifdef RT_SPLITS_INCOHERENT
            s.area = rt_select(mine, RT_INFINITY, s.area);
#endif
#if RT_HAS_TEXTURES
            planar |= mine;
#endif
#ifdef RT_HAS_MIPS
            uv_area = rt_select(mine, rt_vfloat(1.0f), uv_area);
#endif
            continue;
        }
#endif
        const global rt_packed_prim *leaf = ctx->leaves + at;
        const uint kind = RT_REF_KIND(leaf->ref);
#if RT_HAS_SHAPES
        if (kind == RT_REF_SHAPE) {
            const global rt_shape *shape = ctx->shapes + RT_REF_INDEX(leaf->ref);
            const rt_shape_surface found = rt_resolve_shape(ctx, shape, s.at, hit, rt_bits(mine) & bits, RT_USES_UV(ctx, leaf->material));
            shaped |= mine;
            shape_height = rt_select(mine, found.height, shape_height);
            shape_error = rt_select(mine, found.error, shape_error);
            shape_u = rt_select(mine, found.tex_u, shape_u);
            shape_v = rt_select(mine, found.tex_v, shape_v);
            s.geometric = rt_choose(mine, found.normal, s.geometric);
        }
#endif
        s.material = rt_select(mine, rt_vint((int)leaf->material), s.material);
#if RT_HAS_POLYGONS
        anchor = rt_choose(mine, rt_spread(kind == RT_REF_POLYGON ? leaf->b : leaf->a), anchor);
#else
        anchor = rt_choose(mine, rt_spread(leaf->a), anchor);
#endif
#if RT_HAS_SPHERES
        if (kind == RT_REF_SPHERE) radius = rt_select(mine, rt_vfloat(leaf->b[0]), radius);
#endif
#ifdef RT_SPLITS_INCOHERENT
        if (kind != RT_REF_TRIANGLE) s.area = rt_select(mine, RT_INFINITY, s.area);
#endif
#if RT_HAS_TEXTURES
        if (kind == RT_REF_POLYGON) planar |= mine;
        if (kind == RT_REF_SPHERE && RT_USES_UV(ctx, leaf->material)) round |= rt_bits(mine) & bits;
#endif
#ifdef RT_HAS_MIPS
        if (kind == RT_REF_POLYGON || kind == RT_REF_SPHERE) {
            const float side = kind == RT_REF_SPHERE ? 4.0f * 3.14159265f * leaf->b[0] * leaf->b[0] : 1.0f; /* in all, for one picture */
            uv_area = rt_select(mine, rt_vfloat(1.0f), uv_area);
            area = rt_select(mine, rt_vfloat(side), area);
        }
#endif
#ifdef RT_HAS_TANGENTS
        if (kind == RT_REF_SPHERE) of_sphere |= mine;
#endif
#if RT_HAS_ATTRIBUTES
        if (kind == RT_REF_TRIANGLE) {
#ifdef RT_HAS_UVS2
            is_triangle |= mine;
#endif
            const global rt_triangle *tri = ctx->triangles + RT_REF_INDEX(leaf->ref);
            /* Unrolled, the arrays stay in registers. In memory they were cleared in halves and then read whole, and processors
             * wait for such reads. */
            __attribute__((opencl_unroll_hint(3)))
            for (uint i = 0; i < 3u; ++i) {
#if RT_HAS_NORMALS
                normal[i] = rt_choose(mine, rt_spread(ctx->normals + 3u * tri->v[i]), normal[i]);
#endif
#if RT_HAS_UVS
                corner_u[i] = rt_select(mine, rt_vfloat(ctx->uvs[2u * tri->v[i]]), corner_u[i]);
                corner_v[i] = rt_select(mine, rt_vfloat(ctx->uvs[2u * tri->v[i] + 1u]), corner_v[i]);
#endif
#ifdef RT_HAS_UVS2
                corner_u2[i] = rt_select(mine, rt_vfloat(ctx->uvs2[2u * tri->v[i]]), corner_u2[i]);
                corner_v2[i] = rt_select(mine, rt_vfloat(ctx->uvs2[2u * tri->v[i] + 1u]), corner_v2[i]);
#endif
#ifdef RT_HAS_COLORS
                corner_color[i] = rt_choose(mine, rt_spread(ctx->colors + 4u * (size_t)tri->v[i]), corner_color[i]);
#ifdef RT_HAS_CUTOUTS
                corner_alpha[i] = rt_select(mine, rt_vfloat(ctx->colors[4u * (size_t)tri->v[i] + 3u]), corner_alpha[i]);
#endif
#endif
            }
#ifdef RT_HAS_MIPS
            area = rt_select(mine, raw_length, area);
#if RT_HAS_UVS
            uv_area = rt_select(mine, rt_vfloat(rt_uv_area(ctx->uvs, tri)), uv_area);
#endif
#ifdef RT_HAS_UVS2
            uv_area2 = rt_select(mine, rt_vfloat(rt_uv_area(ctx->uvs2, tri)), uv_area2);
#endif
#endif
#ifdef RT_HAS_TANGENTS
            float t[9];
            handed = rt_select(mine, rt_vfloat(rt_load_tangents(leaf, ctx->tangents + 3ul * RT_REF_INDEX(leaf->ref), t)), handed);
            for (uint i = 0; i < 3u; ++i) tangent[i] = rt_choose(mine, rt_splat(t[3 * i], t[3 * i + 1], t[3 * i + 2]), tangent[i]);
#endif
        }
#endif
    }

#if RT_HAS_ATTRIBUTES
    const vfloat v = hit->u, w = hit->v, u = rt_vfloat(1.0f) - v - w;
    s.normal = s.geometric;
#endif
#if RT_HAS_NORMALS
    const rt_vec smooth = rt_along(u, normal[0], rt_along(v, normal[1], rt_scale(w, normal[2])));
    s.normal = rt_choose(RT_MASK(rt_dot(smooth, smooth) > rt_vfloat(1e-12f)), smooth, s.normal); /* zeros: no normals */
#endif
#if RT_HAS_UVS
    s.tex_u = fma(u, corner_u[0], fma(v, corner_u[1], w * corner_u[2]));
    s.tex_v = fma(u, corner_v[0], fma(v, corner_v[1], w * corner_v[2]));
#endif
#ifdef RT_HAS_UVS2
    s.tex_u2 = fma(u, corner_u2[0], fma(v, corner_u2[1], w * corner_u2[2]));
    s.tex_v2 = fma(u, corner_v2[0], fma(v, corner_v2[1], w * corner_v2[2]));
#endif
#ifdef RT_HAS_TANGENTS
    s.tangent = rt_along(u, tangent[0], rt_along(v, tangent[1], rt_scale(w, tangent[2])));
    s.tangent = rt_choose(of_sphere, rt_vec_of(s.geometric.z, zero, -s.geometric.x), s.tangent);
#endif
#ifdef RT_HAS_COLORS
    s.color = rt_along(u, corner_color[0], rt_along(v, corner_color[1], rt_scale(w, corner_color[2])));
#ifdef RT_HAS_CUTOUTS
    s.alpha = fma(u, corner_alpha[0], fma(v, corner_alpha[1], w * corner_alpha[2]));
#endif
#endif
#if RT_HAS_SPHERES && RT_HAS_TEXTURES
    /* Longitude and latitude, poles on Y. Lanes are computed one by one, because a library's vector functions need not agree with
     * its scalar ones. */
    if (round != 0u) {
        float nx[RT_LANES], ny[RT_LANES], nz[RT_LANES], tex_u[RT_LANES], tex_v[RT_LANES];
        rt_store(s.geometric.x, nx);
        rt_store(s.geometric.y, ny);
        rt_store(s.geometric.z, nz);
        rt_store(s.tex_u, tex_u);
        rt_store(s.tex_v, tex_v);
        for (; round != 0u; round &= round - 1u) {
            const uint l = rt_lowest(round);
            const float length = rsqrt(max(nx[l] * nx[l] + ny[l] * ny[l] + nz[l] * nz[l], 1e-36f));
            tex_u[l] = 0.5f + atan2(nx[l], nz[l]) * 0.15915494f;
            tex_v[l] = 0.5f + asin(clamp(ny[l] * length, -1.0f, 1.0f)) * 0.31830989f;
        }
        s.tex_u = rt_load(tex_u);
        s.tex_v = rt_load(tex_v);
    }
#endif
#if RT_HAS_TEXTURES
    if (rt_any(planar)) { /* the texture repeats every unit of length, along the two axes other than the normal's main axis */
        const vfloat x = fabs(s.geometric.x), y = fabs(s.geometric.y), z = fabs(s.geometric.z);
        s.tex_u = rt_select(planar, rt_select(RT_MASK(x > y) & RT_MASK(x > z), s.at.z, s.at.x), s.tex_u);
        s.tex_v = rt_select(planar, rt_select(RT_MASK(y >= x) & RT_MASK(y >= z), -s.at.z, s.at.y), s.tex_v);
    }
#endif

#if RT_HAS_SHAPES
    s.tex_u = rt_select(shaped, shape_u, s.tex_u);
    s.tex_v = rt_select(shaped, shape_v, s.tex_v);
#endif

    rt_vec from_anchor = rt_sub(s.at, anchor);
    s.height = rt_dot(s.geometric, from_anchor);
    s.error = RT_HEIGHT_ERROR * rt_absolute_dot(s.geometric, from_anchor);
#if RT_HAS_PLANES
    s.height -= plane_offset;
#endif
#if RT_HAS_SHAPES
    s.height = rt_select(shaped, shape_height, s.height);
    s.error = rt_select(shaped, shape_error, s.error);
#endif

#if RT_HAS_INSTANCES
    const uint instanced = bits & rt_bits(s.hit & RT_MASK(hit->instance >= rt_vint(0)));
    for (rt_groups g = rt_group_lanes(hit->instance, instanced); rt_next_group(&g, &at, &mine);) {
        const global rt_instance *instance = ctx->instances + at;
        if (instance->material != RT_NONE) s.material = rt_select(mine, rt_vint((int)instance->material), s.material);
        /* In object space, in which the ray was traced, `anchor` and the hit's normal are exact. */
        rt_vec placed, magnitude;
        placed.x = rt_place_row(instance->object_from_world, s.at, &magnitude.x);
        placed.y = rt_place_row(instance->object_from_world + 4, s.at, &magnitude.y);
        placed.z = rt_place_row(instance->object_from_world + 8, s.at, &magnitude.z);
        placed = rt_sub(placed, anchor);
        s.height = rt_select(mine, rt_dot(s.geometric, placed), s.height);
        s.error = rt_select(mine, RT_HEIGHT_ERROR * rt_absolute_dot(s.geometric, placed) + RT_PLACED_ERROR * rt_absolute_dot(s.geometric, magnitude), s.error);
#if defined(RT_HAS_MIPS) || defined(RT_HAS_TANGENTS)
        float columns[9];
        const float determinant = rt_inverse_columns(instance->object_from_world, columns);
#endif
#ifdef RT_HAS_MIPS
        /* The world's cross product of two edges is the transposed matrix times that in object space, divided by the determinant. */
        const rt_vec placed_normal = rt_world_normal(instance->object_from_world, s.geometric);
        const vfloat grown = rt_dot(placed_normal, placed_normal) / rt_max(rt_dot(s.geometric, s.geometric), rt_vfloat(1e-36f));
        area = rt_select(mine, area * sqrt(grown) / rt_vfloat(fabs(determinant)), area);
#endif
#ifdef RT_HAS_TANGENTS
        const vfloat side = rt_vfloat(determinant < 0.0f ? -1.0f : 1.0f);
        s.tangent = rt_choose(mine, rt_scale(side, rt_vec_of(
            fma(rt_vfloat(columns[0]), s.tangent.x, fma(rt_vfloat(columns[3]), s.tangent.y, rt_vfloat(columns[6]) * s.tangent.z)),
            fma(rt_vfloat(columns[1]), s.tangent.x, fma(rt_vfloat(columns[4]), s.tangent.y, rt_vfloat(columns[7]) * s.tangent.z)),
            fma(rt_vfloat(columns[2]), s.tangent.x, fma(rt_vfloat(columns[5]), s.tangent.y, rt_vfloat(columns[8]) * s.tangent.z)))), s.tangent);
        handed = rt_select(mine, side * handed, handed);
#endif
        s.geometric = rt_choose(mine, rt_world_normal(instance->object_from_world, s.geometric), s.geometric);
#if RT_HAS_ATTRIBUTES
        s.normal = rt_choose(mine, rt_world_normal(instance->object_from_world, s.normal), s.normal);
#endif
    }
#endif

    /* Height and error are multiples of the normal's length. Dividing by it makes them lengths in the world, also for instances:
     * there the length includes the scale of the placement. */
    const vfloat scale = rt_inverse_length(s.geometric);
    s.geometric = rt_scale(scale, s.geometric);
    s.height *= scale;
#if RT_HAS_SPHERES
    s.height = rt_select(RT_MASK(radius > zero), sqrt(rt_dot(from_anchor, from_anchor)) - radius, s.height);
#endif
    s.error = fma(scale, s.error, RT_BOX_CLEARANCE * coordinate);
#if RT_HAS_ATTRIBUTES
    s.normal = rt_normalize(s.normal);
    /* In some files vertex normals and the order of corners disagree on the side. The geometric normal decides. */
    const vmask against = RT_MASK(rt_dot(s.normal, s.geometric) < zero);
    s.normal = rt_scale(rt_select(against, rt_vfloat(-1.0f), rt_vfloat(1.0f)), s.normal);
#else
    s.normal = s.geometric;
#endif
#ifdef RT_HAS_UVS2
    s.tex_u2 = rt_select(is_triangle, s.tex_u2, s.tex_u);
    s.tex_v2 = rt_select(is_triangle, s.tex_v2, s.tex_v);
#endif
#ifdef RT_HAS_MIPS
    const vfloat by_area = rt_vfloat(1.0f) / rt_max(area, rt_vfloat(1e-36f));
    s.spread = sqrt(uv_area * by_area);
#ifdef RT_HAS_UVS2
    s.spread2 = rt_select(is_triangle, sqrt(uv_area2 * by_area), s.spread);
#endif
#endif
#ifdef RT_HAS_TANGENTS
    s.tangent = rt_sub(s.tangent, rt_scale(rt_dot(s.tangent, s.normal), s.normal));
    const vmask has_tangent = RT_MASK(rt_dot(s.tangent, s.tangent) > rt_vfloat(1e-20f));
    s.tangent = rt_choose(has_tangent, rt_normalize(s.tangent), rt_splat(0.0f, 0.0f, 0.0f));
    s.unmapped = s.normal;
    s.bitangent = rt_scale(handed, rt_cross(s.normal, s.tangent));
#endif
    return s;
}

#endif
