/* leaf_scene.h -- RT_LEAF in world space, for any kind of primitive; whole, and as RT_LEAF_CANDIDATE and RT_LEAF_TEST.
 *
 * An instance starts a traversal of its mesh's tree with the ray in object space. Kinds that the scene does not have are not
 * compiled. A template, see CONTRACT.md. */
#if RT_HAS_INSTANCES
/* Takes the ray into the instance at a position in leaf order. Returns whether any lane enters its bounds; then *inner is the ray in object
 * space, for the tree of group visit->root, and only lanes that enter are active in *h until rt_leave_instance(). */
RT_INLINE bool RT_FN(rt_enter_instance)(const rt_ctx *ctx, uint at, const rt_rays *r, rt_hits *h, rt_visit *visit, rt_rays *inner)
{
    const global rt_packed_prim *leaf = ctx->leaves + at;
    vfloat entry;
    vmask enters = rt_enter_bounds(rt_vfloat(leaf->a[0]), rt_vfloat(leaf->a[1]), rt_vfloat(leaf->a[2]), rt_vfloat(leaf->b[0]),
                                         rt_vfloat(leaf->b[1]), rt_vfloat(leaf->b[2]), r, h, &entry);
    uint active = rt_bits(enters);
    if (active == 0u) return false;
    const uint index = RT_REF_INDEX(leaf->ref);
    const global rt_instance *instance = ctx->instances + index;
#if RT_HAS_MASKS
    enters &= RT_MASK((r->mask & rt_vint((int)~instance->hidden)) != rt_vint(0));
    active = rt_bits(enters);
    if (active == 0u) return false;
#else
    if (instance->hidden) return false;
#endif
    const global float *m = instance->object_from_world;
    const vfloat ox = r->ox, oy = r->oy, oz = r->oz, dx = r->dx, dy = r->dy, dz = r->dz; /* r and inner may be the same */
    inner->ox = fma(rt_vfloat(m[0]), ox, fma(rt_vfloat(m[1]), oy, fma(rt_vfloat(m[2]), oz, rt_vfloat(m[3]))));
    inner->oy = fma(rt_vfloat(m[4]), ox, fma(rt_vfloat(m[5]), oy, fma(rt_vfloat(m[6]), oz, rt_vfloat(m[7]))));
    inner->oz = fma(rt_vfloat(m[8]), ox, fma(rt_vfloat(m[9]), oy, fma(rt_vfloat(m[10]), oz, rt_vfloat(m[11]))));
    inner->dx = fma(rt_vfloat(m[0]), dx, fma(rt_vfloat(m[1]), dy, rt_vfloat(m[2]) * dz));
    inner->dy = fma(rt_vfloat(m[4]), dx, fma(rt_vfloat(m[5]), dy, rt_vfloat(m[6]) * dz));
    inner->dz = fma(rt_vfloat(m[8]), dx, fma(rt_vfloat(m[9]), dy, rt_vfloat(m[10]) * dz));
    inner->t_min = r->t_min; /* the direction keeps its length, so t means the same in both spaces */
#ifdef RT_COUNT_STEPS
    rt_counts *const counts = r->counts;
#endif
    rt_prepare(inner, active);
#ifdef RT_COUNT_STEPS
    inner->counts = counts;
#endif
    /* The leaves of a mesh number its primitives from 0, so the number of the hit is converted for the traversal, and back. */
    visit->root = instance->root;
    visit->instance = (int)index;
    visit->first = (int)instance->first_prim;
    visit->before = h->prim;
    h->prim -= rt_vint(visit->first);
#if RT_LANES > 1
    visit->enters = enters;
    visit->t = h->t;
    h->t = rt_select(enters, h->t, rt_vfloat(-1.0f));
#endif
#ifdef RT_ALL_HITS
    h->list->first_prim = visit->first;
    h->list->inside = (int)index;
#endif
    return true;
}

RT_INLINE void RT_FN(rt_leave_instance)(const rt_visit *visit, rt_hits *h)
{
#ifdef RT_ALL_HITS
    h->list->first_prim = 0;
    h->list->inside = -1;
#endif
#if RT_LANES > 1
    h->t = rt_select(visit->enters, h->t, visit->t);
#endif
    h->prim += rt_vint(visit->first);
    h->instance = rt_select(RT_MASK(h->prim != visit->before), rt_vint(visit->instance), h->instance);
}

/* A traversal of streams has leaf tests in several places. There this function is not inlined: the mesh's traversal would be
 * compiled as often. */
#if RT_STREAM > 1
RT_NOINLINE
#else
RT_INLINE
#endif
void RT_FN(rt_hit_instance)(const rt_ctx *ctx, uint at, const rt_rays *r, rt_hits *h)
{
    rt_rays inner;
    rt_visit visit;
    if (!RT_FN(rt_enter_instance)(ctx, at, r, h, &visit, &inner)) return;
    RT_FN(rt_mesh)(ctx, visit.root, &inner, h);
    RT_FN(rt_leave_instance)(&visit, h);
}
#endif

/* Any primitive but an instance. */
RT_INLINE void RT_FN(rt_leaf_world_test)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    const global rt_packed_prim *leaf = ctx->leaves + at;
#if RT_HAS_SPHERES
    if (RT_REF_KIND(leaf->ref) == RT_REF_SPHERE) {
        RT_FN(rt_hit_sphere)(leaf, at, ray, hit);
        return;
    }
#endif
#if RT_HAS_POLYGONS
    if (RT_REF_KIND(leaf->ref) == RT_REF_POLYGON) {
        RT_FN(rt_hit_polygon)(ctx, leaf, at, ray, hit);
        return;
    }
#endif
#if RT_HAS_SHAPES
    if (RT_REF_KIND(leaf->ref) == RT_REF_SHAPE) {
        RT_FN(rt_hit_shape)(ctx, leaf, at, ray, hit);
        return;
    }
#endif
    RT_FN(rt_hit_triangle)(leaf, at, ray, hit);
}

RT_INLINE void RT_FN(rt_leaf_scene_test)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
#if RT_HAS_INSTANCES
    if (RT_REF_KIND(ctx->leaves[at].ref) == RT_REF_INSTANCE) {
        RT_FN(rt_hit_instance)(ctx, at, ray, hit);
        return;
    }
#endif
    RT_FN(rt_leaf_world_test)(ctx, at, ray, hit);
}

/* An instance is no primitive; the primitives in it count. */
RT_INLINE void RT_FN(rt_count_leaf_scene)(const rt_ctx *ctx, uint at, const rt_rays *ray)
{
#if RT_HAS_INSTANCES
    if (RT_REF_KIND(ctx->leaves[at].ref) == RT_REF_INSTANCE) return;
#endif
    RT_HOST_COUNT(ray, tests, 1u);
}

RT_INLINE void RT_FN(rt_leaf_scene)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_FN(rt_count_leaf_scene)(ctx, at, ray);
    RT_FN(rt_leaf_scene_test)(ctx, at, ray, hit);
}

/* RT_LEAF of a traversal that goes into instances itself: any primitive but those. */
RT_INLINE void RT_FN(rt_leaf_world)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_HOST_COUNT(ray, tests, 1u);
    RT_FN(rt_leaf_world_test)(ctx, at, ray, hit);
}

#if RT_CPU
RT_INLINE uint RT_FN(rt_leaf_scene_candidate)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_FN(rt_count_leaf_scene)(ctx, at, ray);
#if RT_HAS_SPHERES || RT_HAS_POLYGONS || RT_HAS_SHAPES || RT_HAS_INSTANCES
    if (RT_REF_KIND(ctx->leaves[at].ref) != RT_REF_TRIANGLE) return 1u;
#endif
    return RT_FN(rt_maybe_triangle)(ctx->leaves + at, ray, hit);
}
#endif
