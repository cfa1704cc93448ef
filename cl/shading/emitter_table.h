/* emitter_table.h -- picks emitters by their power, finds the emitter that a primitive is, and loads the emitters of all lanes.
 *
 * An alias table in integers (Walker 1974, "New fast method for generating discrete random numbers with arbitrary frequency
 * distributions"). The RT_PICKS numbers that a float of [0, 1) distinguishes are dealt to the emitters, so rt_emitter.pick is exactly
 * the share of numbers that pick an emitter. Positions are read from the leaves that rays are tested against: a pose that moved them
 * moves the light too. */
#ifndef RT_EMITTER_TABLE_H
#define RT_EMITTER_TABLE_H

/* The emitters of all lanes. kind: RT_LIGHT_*, RT_EMITTER_SKY, or RT_EMITTER_SURFACE for a triangle.
 *   point, spot        p = position, radius = range, u = axis
 *   directional, sun   p = unit vector towards it
 *   rect               p = middle, u and v lead to the middles of its edges
 *   disc               p = middle, u and v are perpendicular radii
 *   triangle           p = a corner, u and v are edges
 *   sphere             p = middle
 * rect, disc and triangle emit to the side of u x v. */
typedef struct rt_lit {
    vint kind, light;
    vint falloff, two_sided; /* masks */
    vfloat pick;
    rt_vec p, u, v, color;
    vfloat radius, cos_inner, cos_outer;
    vfloat area; /* of the polygon that the triangle is a part of; 0: it is none */
    vfloat u1;   /* the random number that is left after a part of a polygon was chosen */
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    vfloat coat, coat_roughness; /* varnish on the surface */
#endif
#ifdef RT_HAS_MAPS
    vint map;         /* of a triangle's emission; -1: none */
    vfloat uv[6];     /* its coordinates at p, and what they gain along u and v */
#endif
} rt_lit;

/* The numbers of a lane, `RT_LANES` apart. */
enum { RT_LIT_P = 0, RT_LIT_U = 3, RT_LIT_V = 6, RT_LIT_COLOR = 9, RT_LIT_RADIUS = 12, RT_LIT_INNER, RT_LIT_OUTER, RT_LIT_AREA, RT_LIT_U1, RT_LIT_PICK, RT_LIT_UV, RT_LIT_COAT = RT_LIT_UV + 6, RT_LIT_COAT_ROUGHNESS, RT_LIT_FIELDS };
#define RT_LIT(field) out[(field) * (int)RT_LANES]
#define RT_LIT_3(field, x, y, z) RT_LIT(field) = (x), RT_LIT((field) + 1) = (y), RT_LIT((field) + 2) = (z)

RT_INLINE void rt_cross_numbers(const float *a, const float *b, float *c)
{
    c[0] = fma(a[1], b[2], -a[2] * b[1]);
    c[1] = fma(a[2], b[0], -a[0] * b[2]);
    c[2] = fma(a[0], b[1], -a[1] * b[0]);
}

/* The triangle of a leaf in the world: a corner and two edges. An instance that mirrors swaps the edges, so that their cross product
 * stays on the side of the triangle's normal. Returns whether they are swapped. */
RT_INLINE bool rt_load_triangle(const rt_ctx *ctx, const global rt_packed_prim *leaf, uint instance, float *p, float *u, float *v)
{
    for (int k = 0; k < 3; ++k) {
        p[k] = leaf->a[k];
        u[k] = leaf->b[k] - p[k];
        v[k] = leaf->c[k] - p[k];
    }
#if RT_HAS_INSTANCES
    if (instance == RT_NONE) return false;
    const global float *m = ctx->instances[instance].object_from_world;
    /* The columns of the inverse are the cross products of the rows, divided by the determinant. */
    float rows[3][3], columns[3][3], moved[3], placed[3][3];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) rows[i][k] = m[4 * i + k];
    for (int i = 0; i < 3; ++i) rt_cross_numbers(rows[(i + 1) % 3], rows[(i + 2) % 3], columns[i]);
    const float determinant = fma(rows[0][0], columns[0][0], fma(rows[0][1], columns[0][1], rows[0][2] * columns[0][2]));
    for (int i = 0; i < 3; ++i) moved[i] = p[i] - m[4 * i + 3];
    for (int k = 0; k < 3; ++k) {
        const float x = columns[0][k] / determinant, y = columns[1][k] / determinant, z = columns[2][k] / determinant;
        placed[0][k] = fma(x, moved[0], fma(y, moved[1], z * moved[2]));
        placed[1][k] = fma(x, u[0], fma(y, u[1], z * u[2]));
        placed[2][k] = fma(x, v[0], fma(y, v[1], z * v[2]));
    }
    const int first = determinant < 0.0f ? 2 : 1;
    for (int k = 0; k < 3; ++k) {
        p[k] = placed[0][k];
        u[k] = placed[first][k];
        v[k] = placed[3 - first][k];
    }
    return first == 2;
#else
    return false;
#endif
}

#ifdef RT_HAS_MAPS
/* The coordinates of a triangle on the texture of a map: at its first corner, and how they change along the edges that
 * rt_load_triangle() gives. */
RT_INLINE void rt_load_triangle_uvs(const rt_ctx *ctx, const global rt_packed_prim *leaf, const global rt_map *map, bool swapped, float *out)
{
    float uv[3][2] = {{0.0f, 0.0f}, {0.0f, 0.0f}, {0.0f, 0.0f}};
#if RT_HAS_UVS
    const global rt_triangle *tri = ctx->triangles + RT_REF_INDEX(leaf->ref);
    const global float *uvs = ctx->uvs;
#ifdef RT_HAS_UVS2
    if (map->set != 0u) uvs = ctx->uvs2;
#endif
    for (uint i = 0; i < 3u; ++i)
        for (uint k = 0; k < 2u; ++k) {
            const global float *m = map->matrix + 3u * k, *at = uvs + 2ul * tri->v[i];
            uv[i][k] = fma(m[0], at[0], fma(m[1], at[1], m[2]));
        }
#endif
    const int first = swapped ? 2 : 1;
    for (int k = 0; k < 2; ++k) {
        out[k] = uv[0][k];
        out[2 + k] = uv[first][k] - uv[0][k];
        out[4 + k] = uv[3 - first][k] - uv[0][k];
    }
}
#endif

#if RT_HAS_POLYGONS
/* Chooses a triangle of a convex polygon's fan in proportion to its area. *u1 is used for that and stretched to [0, 1) again. */
RT_INLINE void rt_load_polygon(const rt_ctx *ctx, const global rt_packed_prim *leaf, float area, float *p, float *u, float *v, float *u1)
{
    const rt_polygon polygon = ctx->polygons[RT_REF_INDEX(leaf->ref)];
    const global float *corners = ctx->polygon_corners + 3ul * polygon.first;
    float left = *u1 * area, n[3];
    for (int k = 0; k < 3; ++k) p[k] = corners[k], v[k] = corners[3 + k] - p[k];
    for (uint c = 2; c < polygon.count; ++c) {
        for (int k = 0; k < 3; ++k) u[k] = v[k], v[k] = corners[3 * c + k] - p[k];
        rt_cross_numbers(u, v, n);
        const float part = 0.5f * sqrt(fma(n[0], n[0], fma(n[1], n[1], n[2] * n[2])));
        if (left < part || c + 1 == polygon.count) {
            *u1 = part > 0.0f ? min(left / part, 0.99999994f) : 0.0f;
            return;
        }
        left -= part;
    }
}
#endif

/* Two unit vectors perpendicular to a unit normal and to each other (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). */
RT_INLINE void rt_disc_axes(const global float *n, float radius, float *u, float *v)
{
    const float sign = copysign(1.0f, n[2]), a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
    u[0] = radius * (1.0f + sign * n[0] * n[0] * a), u[1] = radius * sign * b, u[2] = -radius * sign * n[0];
    v[0] = radius * b, v[1] = radius * (sign + n[1] * n[1] * a), v[2] = -radius * n[1];
}

/* Writes the numbers of emitter e and returns its kind. *flags: RT_LIGHT_* of the light. *map, u1: see rt_lit. */
RT_INLINE uint rt_load_emitter(const rt_ctx *ctx, const global rt_emitter *e, float u1, uint *flags, int *map, float *out)
{
    float p[3] = {0, 0, 0}, u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    uint kind = e->kind;
    *flags = 0u;
    *map = -1;
#ifdef RT_HAS_MAPS
    for (int k = 0; k < 6; ++k) RT_LIT(RT_LIT_UV + k) = 0.0f;
#endif
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    RT_LIT(RT_LIT_COAT) = RT_LIT(RT_LIT_COAT_ROUGHNESS) = 0.0f;
#endif
    RT_LIT(RT_LIT_PICK) = e->pick;
    RT_LIT(RT_LIT_AREA) = 0.0f;
    RT_LIT(RT_LIT_RADIUS) = 0.0f;
    RT_LIT(RT_LIT_INNER) = RT_LIT(RT_LIT_OUTER) = 1.0f;
    RT_LIT_3(RT_LIT_COLOR, 0.0f, 0.0f, 0.0f);
    if (RT_MAY_SHINE(RT_LIGHTS_GIVEN) && kind < RT_LIGHT_KINDS) {
        const global rt_light *light = ctx->lights + e->at;
        *flags = light->flags;
        RT_LIT_3(RT_LIT_COLOR, light->color[0], light->color[1], light->color[2]);
        RT_LIT(RT_LIT_RADIUS) = (1u << kind & RT_LIGHTS_POINTS) != 0u ? light->range : light->radius;
        RT_LIT(RT_LIT_INNER) = light->cos_inner;
        RT_LIT(RT_LIT_OUTER) = light->cos_outer;
        for (int k = 0; k < 3; ++k) {
            p[k] = light->position[k];
            u[k] = (1u << kind & RT_LIGHTS_POINTS) != 0u ? light->normal[k] : light->u[k];
            v[k] = light->v[k];
        }
        if (RT_MAY_SHINE(1u << RT_LIGHT_DISC) && kind == RT_LIGHT_DISC) rt_disc_axes(light->normal, light->radius, u, v);
    } else if (RT_MAY_SHINE(1u << RT_EMITTER_SURFACE) && kind == RT_EMITTER_SURFACE) {
        const global rt_packed_prim *leaf = ctx->leaves + e->at;
        uint number = leaf->material;
#if RT_HAS_INSTANCES
        if (e->instance != RT_NONE && ctx->instances[e->instance].material != RT_NONE) number = ctx->instances[e->instance].material;
#endif
        const global rt_material *material = ctx->materials + number;
        RT_LIT_3(RT_LIT_COLOR, material->emission[0], material->emission[1], material->emission[2]);
        *flags = material->flags & RT_MATERIAL_ONE_SIDED ? 0u : RT_LIGHT_TWO_SIDED;
#if RT_MAY_SCATTER(RT_LOBE_COAT)
        if (material->model == RT_MODEL_GLTF) {
            RT_LIT(RT_LIT_COAT) = ctx->layers[number].clearcoat;
            RT_LIT(RT_LIT_COAT_ROUGHNESS) = ctx->layers[number].clearcoat_roughness;
        }
#endif
#if RT_HAS_SPHERES
        if (RT_REF_KIND(leaf->ref) == RT_REF_SPHERE) {
            kind = RT_LIGHT_SPHERE;
            for (int k = 0; k < 3; ++k) p[k] = leaf->a[k];
            RT_LIT(RT_LIT_RADIUS) = leaf->b[0];
        }
#endif
#if RT_HAS_POLYGONS
        if (RT_REF_KIND(leaf->ref) == RT_REF_POLYGON) {
            RT_LIT(RT_LIT_AREA) = e->area;
            rt_load_polygon(ctx, leaf, e->area, p, u, v, &u1);
        }
#endif
        if (RT_REF_KIND(leaf->ref) == RT_REF_TRIANGLE) {
            const bool swapped = rt_load_triangle(ctx, leaf, e->instance, p, u, v);
#ifdef RT_HAS_MAPS
            const global rt_map *of = rt_map_of(ctx, material, RT_MAP_EMISSION);
            if (of) {
                float uv[6];
                rt_load_triangle_uvs(ctx, leaf, of, swapped, uv);
                for (int k = 0; k < 6; ++k) RT_LIT(RT_LIT_UV + k) = uv[k];
                *map = (int)(of - ctx->maps);
            }
#endif
        }
    }
    RT_LIT_3(RT_LIT_P, p[0], p[1], p[2]);
    RT_LIT_3(RT_LIT_U, u[0], u[1], u[2]);
    RT_LIT_3(RT_LIT_V, v[0], v[1], v[2]);
    RT_LIT(RT_LIT_U1) = u1;
    return kind;
}

/* The emitters that the numbers u_pick of [0, 1) pick. u1: a second number, for what an emitter consists of. */
RT_INLINE rt_lit rt_pick_emitters(const rt_ctx *ctx, vfloat u_pick, vfloat u1)
{
    const uint rest_bits = RT_PICK_BITS - ctx->lighting->cell_bits;
    int number[RT_LANES], kind[RT_LANES], light[RT_LANES], falloff[RT_LANES], two_sided[RT_LANES], map[RT_LANES];
    float first[RT_LANES], columns[RT_LIT_FIELDS * RT_LANES];
    rt_store(min(max(rt_to_int(u_pick * rt_vfloat((float)RT_PICKS)), rt_vint(0)), rt_vint(RT_PICKS - 1)), number);
    rt_store(u1, first);
    for (uint l = 0; l < RT_LANES; ++l) {
        const uint cell = (uint)number[l] >> rest_bits, rest = (uint)number[l] & ((1u << rest_bits) - 1u);
        const global rt_emitter *e = ctx->emitters + cell;
        if (rest >= e->threshold) e = ctx->emitters + e->alias;
        uint flags;
        kind[l] = (int)rt_load_emitter(ctx, e, first[l], &flags, map + l, columns + l);
        light[l] = (int)e->at;
        if (e->kind == RT_EMITTER_SURFACE) light[l] = (int)RT_LIGHT_OF_SURFACES;
        if (e->kind == RT_EMITTER_SKY) light[l] = (int)RT_LIGHT_OF_SKY;
        falloff[l] = flags & RT_LIGHT_FALLOFF ? -1 : 0;
        two_sided[l] = flags & RT_LIGHT_TWO_SIDED ? -1 : 0;
    }
    rt_lit lit;
    lit.kind = rt_load(kind);
    lit.light = rt_load(light);
    lit.falloff = rt_load(falloff);
    lit.two_sided = rt_load(two_sided);
#define RT_LIT_COLUMN(field) rt_load(columns + (field)*RT_LANES)
#define RT_LIT_VECTOR(field) rt_vec_of(RT_LIT_COLUMN(field), RT_LIT_COLUMN((field) + 1), RT_LIT_COLUMN((field) + 2))
    lit.pick = RT_LIT_COLUMN(RT_LIT_PICK);
    lit.p = RT_LIT_VECTOR(RT_LIT_P);
    lit.u = RT_LIT_VECTOR(RT_LIT_U);
    lit.v = RT_LIT_VECTOR(RT_LIT_V);
    lit.color = RT_LIT_VECTOR(RT_LIT_COLOR);
    lit.radius = RT_LIT_COLUMN(RT_LIT_RADIUS);
    lit.cos_inner = RT_LIT_COLUMN(RT_LIT_INNER);
    lit.cos_outer = RT_LIT_COLUMN(RT_LIT_OUTER);
    lit.area = RT_LIT_COLUMN(RT_LIT_AREA);
    lit.u1 = RT_LIT_COLUMN(RT_LIT_U1);
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    lit.coat = RT_LIT_COLUMN(RT_LIT_COAT);
    lit.coat_roughness = RT_LIT_COLUMN(RT_LIT_COAT_ROUGHNESS);
#endif
#ifdef RT_HAS_MAPS
    lit.map = rt_load(map);
    for (int k = 0; k < 6; ++k) lit.uv[k] = RT_LIT_COLUMN(RT_LIT_UV + k);
#endif
#undef RT_LIT_COLUMN
#undef RT_LIT_VECTOR
    return lit;
}

/* The emitter that a primitive is; null if it is none that is picked. */
RT_INLINE const global rt_emitter *rt_emitter_of_prim(const rt_ctx *ctx, uint prim)
{
    const global rt_emitter_run *runs = ctx->emitter_runs;
    uint first = 0, end = ctx->lighting->run_count; /* the run, if any, is within [first, end) */
    while (end - first > 1u) {
        const uint middle = (first + end) / 2u;
        if (runs[middle].first_prim <= prim)
            first = middle;
        else
            end = middle;
    }
    if (end == 0u || prim < runs[first].first_prim) return 0;
    const uint number = runs[first].first_emitter + prim - runs[first].first_prim;
    return number < runs[first + 1u].first_emitter ? ctx->emitters + number : 0;
}

#endif
