/* leaf_scene.h -- RT_LEAF in world space: any kind of primitive, and instances, which start a traversal of their mesh's tree
 * with the ray in object space. Kinds that the scene does not hold are compiled out. A template, see CONTRACT.md. */
#if RT_HAS_INSTANCES
/* Lanes that come to an instance's bounds, those of `r` in its mesh's space, and `h` as the mesh's tree is to find it: other
 * lanes are done, and leaves of a mesh count their primitives from 0, so the number to beat is turned into theirs. */
RT_INLINE vmask RT_FN(rt_into_instance)(const global rt_leaf *leaf, const global rt_instance *instance, const rt_rays *r, rt_hits *h,
                                        rt_rays *inner)
{
    const global float *m = instance->object_from_world;
    vfloat entry;
    const vmask enters = rt_enter_bounds(rt_vfloat(leaf->a[0]), rt_vfloat(leaf->a[1]), rt_vfloat(leaf->a[2]), rt_vfloat(leaf->b[0]),
                                         rt_vfloat(leaf->b[1]), rt_vfloat(leaf->b[2]), r, h, &entry);
    const uint active = rt_bits(enters);
    h->t = rt_select(enters, h->t, rt_vfloat(-1.0f));
    if (active == 0u) return enters;
    h->prim -= rt_vint((int)instance->first_prim);
    inner->ox = fma(rt_vfloat(m[0]), r->ox, fma(rt_vfloat(m[1]), r->oy, fma(rt_vfloat(m[2]), r->oz, rt_vfloat(m[3]))));
    inner->oy = fma(rt_vfloat(m[4]), r->ox, fma(rt_vfloat(m[5]), r->oy, fma(rt_vfloat(m[6]), r->oz, rt_vfloat(m[7]))));
    inner->oz = fma(rt_vfloat(m[8]), r->ox, fma(rt_vfloat(m[9]), r->oy, fma(rt_vfloat(m[10]), r->oz, rt_vfloat(m[11]))));
    inner->dx = fma(rt_vfloat(m[0]), r->dx, fma(rt_vfloat(m[1]), r->dy, rt_vfloat(m[2]) * r->dz));
    inner->dy = fma(rt_vfloat(m[4]), r->dx, fma(rt_vfloat(m[5]), r->dy, rt_vfloat(m[6]) * r->dz));
    inner->dz = fma(rt_vfloat(m[8]), r->dx, fma(rt_vfloat(m[9]), r->dy, rt_vfloat(m[10]) * r->dz));
    inner->t_min = r->t_min; /* the direction keeps its length, so t means the same in both spaces */
    rt_prepare(inner, active);
    return enters;
}

/* Back in the scene's. */
RT_INLINE void RT_FN(rt_leave_instance)(const global rt_instance *instance, uint index, vmask entered, vfloat t_before, vint prim_before,
                                        rt_hits *h)
{
    h->t = rt_select(entered, h->t, t_before);
    h->prim += rt_vint((int)instance->first_prim);
    h->instance = rt_select(RT_MASK(h->prim != prim_before), rt_vint((int)index), h->instance);
}

/* Where packets go by bundles, the tree of the scene has leaf tests in several places, and a mesh's tree would be compiled as often. */
#if RT_BUNDLE > 1
RT_NOINLINE
#else
RT_INLINE
#endif
void RT_FN(rt_hit_instance)(const rt_ctx *ctx, uint at, const rt_rays *r, rt_hits *h)
{
    const global rt_leaf *leaf = ctx->leaves + at;
    const uint index = RT_REF_INDEX(leaf->ref);
    const global rt_instance *instance = ctx->instances + index;
    const vfloat t = h->t;
    const vint prim = h->prim;
    rt_rays inner;
    const vmask entered = RT_FN(rt_into_instance)(leaf, instance, r, h, &inner);
    if (!rt_any(entered)) {
        h->t = t;
        return;
    }
    RT_FN(rt_mesh)(ctx, instance->root, &inner, h);
    RT_FN(rt_leave_instance)(instance, index, entered, t, prim, h);
}
#endif

RT_INLINE void RT_FN(rt_leaf_scene)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    const global rt_leaf *leaf = ctx->leaves + at;
#if RT_HAS_SPHERES || RT_HAS_POLYGONS || RT_HAS_INSTANCES
    const uint kind = RT_REF_KIND(leaf->ref);
#if RT_HAS_INSTANCES
    if (kind == RT_REF_INSTANCE) {
        RT_FN(rt_hit_instance)(ctx, at, ray, hit);
        return;
    }
#endif
    RT_COUNT_LEAF(hit);
#if RT_HAS_SPHERES
    if (kind == RT_REF_SPHERE) {
        RT_FN(rt_hit_sphere)(leaf, at, ray, hit);
        return;
    }
#endif
#if RT_HAS_POLYGONS
    if (kind == RT_REF_POLYGON) {
        RT_FN(rt_hit_polygon)(ctx, leaf, at, ray, hit);
        return;
    }
#endif
#else
    RT_COUNT_LEAF(hit);
#endif
    RT_FN(rt_hit_triangle)(leaf, at, ray, hit);
}
