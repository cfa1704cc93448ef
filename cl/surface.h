/* surface.h -- from a hit to what shading needs: normals, texture coordinates, material, primitive number. */
#ifndef RT_SURFACE_H
#define RT_SURFACE_H

/* Scatter: lane l of value goes to buffer[index lane l], for the lanes in bits. */
#define RT_FOR_LANES_STORE(buffer, index, value, bits)                                                                           \
    {                                                                                                                            \
        float store_values[RT_LANES];                                                                                            \
        int store_index[RT_LANES];                                                                                               \
        rt_store(value, store_values);                                                                                           \
        rt_store(index, store_index);                                                                                            \
        for (uint store_l = 0; store_l < RT_LANES; ++store_l)                                                                    \
            if ((bits) >> store_l & 1u) buffer[store_index[store_l]] = store_values[store_l];                                    \
    }

/* Arcs of spheres that nobody looks at were an eighth of a frame. */
#ifdef RT_AOV
#define RT_USES_UV(ctx, number) 1
#else
#define RT_USES_UV(ctx, number) ((ctx)->materials[number].texture != RT_NONE)
#endif

typedef struct rt_surface {
    vmask hit;
    rt_vec geometric;    /* unit normal, world, on the side that the primitive has it */
    rt_vec normal;       /* for shading: interpolated where there are vertex normals; unit, on the geometric one's side */
    vfloat tex_u, tex_v; /* (0,0) at the bottom left of a texture */
    vint prim;           /* -1: nothing hit */
    vint material;
} rt_surface;

RT_INLINE rt_surface rt_resolve(const rt_ctx *ctx, const rt_rays *ray, const rt_hits *hit, uint bits)
{
    float nx[RT_LANES], ny[RT_LANES], nz[RT_LANES], tex_u[RT_LANES], tex_v[RT_LANES];
    int leaf_at[RT_LANES], instance_at[RT_LANES], material[RT_LANES];
    rt_store(hit->leaf, leaf_at);
    rt_store(hit->instance, instance_at);
    rt_store(rt_vint(0), material);
    rt_store(rt_vfloat(0.0f), tex_u);
    rt_store(rt_vfloat(0.0f), tex_v);
    rt_store(hit->nx, nx);
    rt_store(hit->ny, ny);
    rt_store(hit->nz, nz);
#if RT_HAS_ATTRIBUTES || RT_HAS_TEXTURES
    float hu[RT_LANES], hv[RT_LANES];
    rt_store(hit->u, hu);
    rt_store(hit->v, hv);
#endif
#if RT_HAS_ATTRIBUTES
    float sx[RT_LANES], sy[RT_LANES], sz[RT_LANES];
    rt_store(hit->nx, sx);
    rt_store(hit->ny, sy);
    rt_store(hit->nz, sz);
#endif
#if RT_HAS_TEXTURES
    float px[RT_LANES], py[RT_LANES], pz[RT_LANES];
    rt_store(fma(hit->t, ray->dx, ray->ox), px);
    rt_store(fma(hit->t, ray->dy, ray->oy), py);
    rt_store(fma(hit->t, ray->dz, ray->oz), pz);
#endif
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u || leaf_at[l] == -1) continue;
        int planar = 0;
#if RT_HAS_PLANES
        if (leaf_at[l] < -1) {
            const global rt_plane *plane = ctx->planes + (-2 - leaf_at[l]);
            material[l] = (int)plane->material;
            planar = 1;
        } else
#endif
        {
            const global rt_leaf *leaf = ctx->leaves + leaf_at[l];
            const uint kind = RT_REF_KIND(leaf->ref);
            material[l] = (int)leaf->material;
            planar = kind == RT_REF_POLYGON;
#if RT_HAS_ATTRIBUTES
            if (kind == RT_REF_TRIANGLE) {
                const global rt_triangle *tri = ctx->triangles + RT_REF_INDEX(leaf->ref);
                const uint a = tri->v[0], b = tri->v[1], c = tri->v[2];
                const float v = hu[l], w = hv[l], u = 1.0f - v - w;
#if RT_HAS_NORMALS
                const global float *na = ctx->normals + 3u * a, *nb = ctx->normals + 3u * b, *nc = ctx->normals + 3u * c;
                const float x = fma(u, na[0], fma(v, nb[0], w * nc[0])), y = fma(u, na[1], fma(v, nb[1], w * nc[1])),
                            z = fma(u, na[2], fma(v, nb[2], w * nc[2]));
                if (x * x + y * y + z * z > 1e-12f) { /* a mesh without normals stores zeros */
                    sx[l] = x;
                    sy[l] = y;
                    sz[l] = z;
                }
#endif
#if RT_HAS_UVS
                const global float *ta = ctx->uvs + 2u * a, *tb = ctx->uvs + 2u * b, *tc = ctx->uvs + 2u * c;
                tex_u[l] = fma(u, ta[0], fma(v, tb[0], w * tc[0]));
                tex_v[l] = fma(u, ta[1], fma(v, tb[1], w * tc[1]));
#endif
            }
#endif
#if RT_HAS_SPHERES && RT_HAS_TEXTURES
            if (kind == RT_REF_SPHERE && RT_USES_UV(ctx, leaf->material)) { /* longitude and latitude, poles on Y */
                const float length = rsqrt(max(nx[l] * nx[l] + ny[l] * ny[l] + nz[l] * nz[l], 1e-36f));
                tex_u[l] = 0.5f + atan2(nx[l], nz[l]) * 0.15915494f;
                tex_v[l] = 0.5f + asin(clamp(ny[l] * length, -1.0f, 1.0f)) * 0.31830989f;
            }
#endif
        }
#if RT_HAS_TEXTURES
        if (planar) { /* one texture a unit, over the two axes that the plane faces least */
            const float x = fabs(nx[l]), y = fabs(ny[l]), z = fabs(nz[l]);
            tex_u[l] = x > y && x > z ? pz[l] : px[l];
            tex_v[l] = y >= x && y >= z ? -pz[l] : py[l];
        }
#endif
#if RT_HAS_INSTANCES
        if (instance_at[l] >= 0) {
            const global rt_instance *instance = ctx->instances + instance_at[l];
            const global float *m = instance->object_from_world;
            if (instance->material != RT_NONE) material[l] = (int)instance->material;
            /* Normals go with the transpose of the inverse. */
            const float x = nx[l], y = ny[l], z = nz[l];
            nx[l] = m[0] * x + m[4] * y + m[8] * z;
            ny[l] = m[1] * x + m[5] * y + m[9] * z;
            nz[l] = m[2] * x + m[6] * y + m[10] * z;
#if RT_HAS_ATTRIBUTES
            const float ax = sx[l], ay = sy[l], az = sz[l];
            sx[l] = m[0] * ax + m[4] * ay + m[8] * az;
            sy[l] = m[1] * ax + m[5] * ay + m[9] * az;
            sz[l] = m[2] * ax + m[6] * ay + m[10] * az;
#endif
        }
#endif
    }

    rt_surface s;
    s.prim = hit->prim;
    s.material = rt_load(material);
    s.hit = RT_MASK(s.prim >= rt_vint(0));
    s.geometric = rt_normalize(rt_vec_of(rt_load(nx), rt_load(ny), rt_load(nz)));
#if RT_HAS_ATTRIBUTES
    s.normal = rt_normalize(rt_vec_of(rt_load(sx), rt_load(sy), rt_load(sz)));
    /* Files disagree on which side corners turn; the geometric normal decides. */
    const vmask against = RT_MASK(rt_dot(s.normal, s.geometric) < rt_vfloat(0.0f));
    s.normal = rt_scale(rt_select(against, rt_vfloat(-1.0f), rt_vfloat(1.0f)), s.normal);
#else
    s.normal = s.geometric;
#endif
    s.tex_u = rt_load(tex_u);
    s.tex_v = rt_load(tex_v);
    return s;
}

#endif
