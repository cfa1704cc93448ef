/* emission.h -- what a ray finds of light: area lights, which are no primitives, and surfaces that emit; and the density with which
 * rt_light_draw() would have drawn the same direction from the ray's origin. */
#ifndef RT_EMISSION_H
#define RT_EMISSION_H

/* Finds the nearest area light of each ray that is not farther than *t: distance of the surface that it hit, infinite for none, negative
 * for inactive lanes. Changes *t, and sets *light, the light's number, or -1. Directions have unit length. */
RT_INLINE void rt_hit_lights(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *ray, vfloat *t, vint *light)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_vec origin = rt_vec_of(ray->ox, ray->oy, ray->oz), direction = rt_vec_of(ray->dx, ray->dy, ray->dz);
    *light = rt_vint(-1);
    for (uint i = 0; RT_MAY_SHINE(RT_LIGHTS_SOLID) && i < frame->light_count; ++i) {
        const global rt_light *l = ctx->lights + i;
        if ((1u << l->kind & RT_LIGHTS_SOLID) == 0u) continue;
        const rt_vec to = rt_sub(rt_spread(l->position), origin);
        vfloat distance;
        vmask meets;
        if (RT_MAY_SHINE(1u << RT_LIGHT_SPHERE) && l->kind == RT_LIGHT_SPHERE) {
            vmask from_within;
            distance = rt_meet_sphere(to, rt_vfloat(l->radius), direction, &from_within);
            meets = RT_MASK(distance > zero);
            if (!(l->flags & RT_LIGHT_TWO_SIDED)) meets &= ~from_within;
        } else {
            const rt_vec n = rt_spread(l->normal);
            const vfloat facing = rt_dot(n, direction);
            distance = rt_dot(n, to) / facing;
            meets = l->flags & RT_LIGHT_TWO_SIDED ? RT_MASK(facing != zero) : RT_MASK(facing < zero);
            meets &= rt_on_flat(l, rt_sub(rt_scale(distance, direction), to));
        }
        meets &= RT_MASK(distance > zero) & RT_MASK(distance >= ray->t_min) & RT_MASK(distance <= *t);
        *t = rt_select(meets, distance, *t);
        *light = rt_select(meets, rt_vint((int)i), *light);
    }
}

/* The radiance of the area lights that rays found at distances t, for the lanes with light >= 0. */
RT_INLINE rt_vec rt_emission_of_light(const rt_ctx *ctx, const rt_rays *ray, vfloat t, vint light, vmask lanes, vfloat *pdf)
{
    const vfloat zero = rt_vfloat(0.0f);
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f);
    *pdf = zero;
    int i;
    vmask mine;
    for (rt_groups g = rt_group_lanes(light, rt_bits(lanes & RT_MASK(light >= rt_vint(0)))); rt_next_group(&g, &i, &mine);) {
        mine &= lanes;
        const global rt_light *l = ctx->lights + i;
        vfloat density;
        if (RT_MAY_SHINE(1u << RT_LIGHT_SPHERE) && l->kind == RT_LIGHT_SPHERE) {
            density = rt_sphere_density(rt_sub(rt_spread(l->position), rt_vec_of(ray->ox, ray->oy, ray->oz)), rt_vfloat(l->radius));
        } else {
            const vfloat cosine = fabs(rt_dot(rt_spread(l->normal), rt_vec_of(ray->dx, ray->dy, ray->dz)));
            density = rt_flat_density(t * t, rt_vfloat(rt_flat_side(l)), rt_max(cosine, rt_vfloat(1e-20f)));
        }
        *pdf = rt_select(mine, rt_vfloat(ctx->emitters[i].pick) * density, *pdf);
        sum = rt_choose(mine, rt_spread(l->color), sum);
    }
    return sum;
}

/* The radiance that the surfaces of hits emit towards the rays' origins. pdf is 0 where no light is drawn from that surface. */
RT_PART rt_vec rt_emission_of_hit(const rt_ctx *ctx, const rt_rays *ray, const rt_hits *hit, const rt_surface *surface, vmask lanes, vfloat *pdf)
{
    const vfloat zero = rt_vfloat(0.0f);
    const rt_vec direction = rt_vec_of(ray->dx, ray->dy, ray->dz);
    const vfloat facing = -rt_dot(surface->geometric, direction);
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f);
    *pdf = zero;
    vmask emits = rt_vint(0);
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(surface->material, rt_bits(lanes)); rt_next_group(&g, &id, &mine);) {
        mine &= lanes;
        const global rt_material *m = ctx->materials + id;
        if (m->emission[0] <= 0.0f && m->emission[1] <= 0.0f && m->emission[2] <= 0.0f) continue;
        if (m->flags & RT_MATERIAL_ONE_SIDED) mine &= RT_MASK(facing > zero);
        sum = rt_choose(mine, rt_sharp_emission(ctx, m, surface, mine), sum);
#if RT_MAY_SCATTER(RT_LOBE_COAT)
        if (m->model == RT_MODEL_GLTF && ctx->layers[id].clearcoat > 0.0f) {
            vfloat coat = rt_vfloat(ctx->layers[id].clearcoat), roughness = rt_vfloat(ctx->layers[id].clearcoat_roughness);
#ifdef RT_HAS_MAPS
            rt_map_coat(ctx, m, surface, mine, &coat, &roughness);
#endif
            sum = rt_choose(mine, rt_scale(rt_through_coat(coat, rt_alpha_of(roughness), facing), sum), sum);
        }
#endif
        emits |= mine;
    }
    uint left = rt_bits(emits);
    if (left == 0u || ctx->lighting->run_count == 0u) return sum;

    int prim[RT_LANES], leaf_at[RT_LANES], instance[RT_LANES];
    float pick[RT_LANES], size[RT_LANES], middle[3 * RT_LANES];
    rt_store(hit->prim, prim);
    rt_store(hit->leaf, leaf_at);
    rt_store(hit->instance, instance);
    for (uint l = 0; l < RT_LANES; ++l) pick[l] = 0.0f, size[l] = 1.0f, middle[l] = middle[RT_LANES + l] = middle[2 * RT_LANES + l] = 0.0f;
    vmask round = rt_vint(0);
    for (; left != 0u; left &= left - 1u) {
        const uint l = rt_lowest(left);
        const global rt_emitter *e = rt_emitter_of_prim(ctx, (uint)prim[l]);
        if (!e || leaf_at[l] < 0) continue;
        const global rt_packed_prim *leaf = ctx->leaves + leaf_at[l];
        pick[l] = e->pick;
#if RT_HAS_SPHERES
        if (RT_REF_KIND(leaf->ref) == RT_REF_SPHERE) {
            for (int k = 0; k < 3; ++k) middle[k * (int)RT_LANES + (int)l] = leaf->a[k];
            size[l] = leaf->b[0];
            round |= RT_MASK(rt_lane_index() == rt_vint((int)l));
            continue;
        }
#endif
        size[l] = e->area;
        if (RT_REF_KIND(leaf->ref) == RT_REF_TRIANGLE) {
            float p[3], u[3], v[3], n[3];
            rt_load_triangle(ctx, leaf, instance[l] < 0 ? RT_NONE : (uint)instance[l], p, u, v);
            rt_cross_numbers(u, v, n);
            size[l] = 0.5f * sqrt(fma(n[0], n[0], fma(n[1], n[1], n[2] * n[2])));
        }
    }
    const vfloat t = hit->t, sizes = rt_load(size);
    vfloat density = rt_flat_density(t * t, rt_max(sizes, rt_vfloat(1e-36f)), rt_max(fabs(facing), rt_vfloat(1e-20f)));
#if RT_HAS_SPHERES
    const rt_vec middles = rt_vec_of(rt_load(middle), rt_load(middle + RT_LANES), rt_load(middle + 2 * RT_LANES));
    const rt_vec to = rt_sub(middles, rt_vec_of(ray->ox, ray->oy, ray->oz));
    density = rt_select(round, rt_sphere_density(to, sizes), density);
#endif
    *pdf = rt_select(emits, rt_load(pick) * density, zero);
    return sum;
}

#endif
