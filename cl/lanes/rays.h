/* rays.h -- rays and hits of all lanes, and the slab tests that traversals share. */
#ifndef RT_RAYS_H
#define RT_RAYS_H

/* Functions of a packet that also take one ray (spread_ray.h). */
#if RT_LANES > 1
#define RT_OVERLOADED __attribute__((overloadable))
#else
#define RT_OVERLOADED
#endif

#ifdef RT_COUNT_STEPS
/* What the host's helpers count for a ray, or for a packet. Queries keep it out of the reach of traversals (cl/primitives/query.h). */
typedef struct rt_counts {
    RT_HELPER_COUNTERS(RT_COUNTER_MEMBER)
} rt_counts;
#endif

typedef struct rt_rays {
    vfloat ox, oy, oz;             /* origin */
    vfloat dx, dy, dz;             /* direction; unit in world space, not inside instances, so t stays comparable */
    vfloat t_min;
    vfloat ix, iy, iz;             /* 1 / direction, finite: components are clamped away from zero */
    vfloat near_x, near_y, near_z; /* -origin / direction, rounded down */
    vfloat far_x, far_y, far_z;    /* -origin / direction, rounded up, with RT_FAR_SLACK */
    int coherent;                  /* all active lanes have the same signs: then */
    uint lo_x, lo_y, lo_z;         /* index of the near plane in a box {lo.xyz, hi.xyz}; the far one is 3 away */
    int incoherent;                /* they start far apart (rt_incoherent()), so they will share few nodes */
    int same_axis;                 /* all active lanes have the same dominant axis: then */
    uint kx, ky, kz;               /* kz is it, kx and ky the other two; else */
    vint axis_x, axis_y, axis_z;   /* they differ by lane, and only then are these filled in */
#if RT_HAS_MASKS
    vint mask;                     /* what instances must have a bit of: RT_SEEN_BY_*; set by RT_SEEN_BY */
#endif
#ifdef RT_CARRIES_CONES
    vfloat travelled;              /* how long the rays before it were together, back to the camera */
#endif
    vfloat px, py, pz;             /* origin: pz along the dominant axis, px and py on the other two */
    vfloat sx, sy, sz;             /* shear along the dominant axis; 1 / direction on it */
#ifdef RT_COUNT_STEPS
    rt_counts *counts;             /* 0: outside of a query */
#endif
} rt_rays;

/* The nearest hit so far. A lane that is inactive, or occluded in an any-hit query, has t = -1: every test then fails for
 * it. */
typedef struct rt_hits {
    vfloat t;
    vfloat u, v;       /* weights of corners b and c of a triangle */
    vfloat nx, ny, nz; /* geometric normal in the space of the hit's group, not unit, either side */
    vint leaf;         /* position in leaf order; -1: none; -2 - i: plane i */
    vint prim;         /* the primitive's number; the lower of two at the same t is the hit, whatever the order of visits */
    vint instance;     /* -1: none */
#ifdef RT_ALL_HITS
    rt_hit_list *list; /* takes all hits; u to instance have no value */
#endif
#ifdef RT_COUNT_STEPS
    RT_HIT_COUNTERS(RT_COUNTER_MEMBER)
#endif
#ifdef RT_DEBUG
    uint overflow;
#ifdef RT_STACK_GRANTED
    uint granted; /* pushes */
#endif
#endif
#ifdef RT_STEP_BUDGET
    int step_budget; /* steps that the traversal may still take; negative: it was stopped */
#endif
} rt_hits;

#if RT_HAS_INSTANCES
/* What is kept of rays in the world while they are in an instance. */
typedef struct rt_visit {
    uint root;    /* of the mesh's tree */
    int instance; /* its index; a traversal may set -1 where the rays are in none */
    int first;    /* number of its first primitive */
    vint before;  /* number of the hit's primitive */
#if RT_LANES > 1
    vmask enters; /* the lanes that are in the instance */
    vfloat t;     /* of the hits before */
#endif
} rt_visit;
#endif

/* Says of which kind rays are, RT_SEEN_BY_* as a vint. Nothing where no instance has a mask. */
#if RT_HAS_MASKS
#define RT_SEEN_BY(ray, kind) (ray)->mask = (kind);
#else
#define RT_SEEN_BY(ray, kind)
#endif

#ifdef RT_COUNT_STEPS
#define RT_COUNTED_MEAN(a, b) ((a) + (b))
#define RT_COUNTED_SUM(a, b) ((a) + (b))
#define RT_COUNTED_GREATEST(a, b) max(a, b)
#define RT_PACKET_MEAN(before, sum, rays) ((before) + ((sum) - (before) + (rays) - 1u) / (rays))
#define RT_PACKET_SUM(before, sum, rays) (sum)
#define RT_PACKET_GREATEST(before, greatest, rays) (greatest)
/* rt_count_nodes(counts, n) and the like. */
#define RT_COUNTER_FUNCTION(name, how, of_hit)                                                                                 \
    RT_INLINE void rt_count_##name(rt_counts *counts, uint n) { counts->name = RT_COUNTED_##how(counts->name, n); }
RT_HELPER_COUNTERS(RT_COUNTER_FUNCTION)
#undef RT_COUNTER_FUNCTION
#define RT_COUNTER_CLEAR(name, how, of_hit) to->name = 0u;
#define RT_COUNTER_ADD(name, how, of_hit) to->name = RT_COUNTED_##how(to->name, from->name);
#define RT_COUNTER_OF_PACKET(name, how, of_hit) to->name = RT_PACKET_##how(before->name, to->name, rays);
RT_INLINE RT_OVERLOADED void rt_clear_counters(rt_hits *to) { RT_HIT_COUNTERS(RT_COUNTER_CLEAR) }
RT_INLINE RT_OVERLOADED void rt_add_counters(rt_hits *to, const rt_hits *from) { RT_HIT_COUNTERS(RT_COUNTER_ADD) }
/* The host's counts of a query are in a variable of the query's own, and go to the hit in the end. So they do not depend on what a
 * traversal writes to the hit. Where none of the host's helpers counted a node, the traversal's own count is taken. */
#define RT_COUNTER_FINISH(name, how, of_hit) hit->of_hit = RT_COUNTED_##how(before->of_hit, counted->name);
RT_INLINE void rt_finish_counters(const rt_rays *ray, rt_hits *hit, const rt_hits *before, const rt_counts *counted)
{
    RT_HELPER_COUNTERS(RT_COUNTER_FINISH)
    const uint own = counted->nodes != 0u ? 0u : hit->visits - before->visits;
    hit->steps += own;
    hit->own_steps = before->own_steps + own;
    ((rt_rays *)ray)->counts = 0;
}
#else
#define rt_clear_counters(to) ((void)0)
#define rt_add_counters(to, from) ((void)0)
#endif

/* For programs that count; see CONTRACT.md. Other programs do not pay: code that only feeds these macros is dead there. */
#ifdef RT_COUNT_STEPS
#define RT_HOST_COUNT(ray, what, n) ((ray)->counts ? rt_count_##what((ray)->counts, n) : (void)0)
#define RT_NODE(ray, node) (RT_HOST_COUNT(ray, nodes, 1u), (node))
#define RT_COUNT_VISIT(hit, inside) ((hit)->visits++, (hit)->lane_steps += popcount(inside))
#define RT_COUNT_BOXES(hit, n) ((hit)->own_boxes += (n))
#define RT_COUNT_LEAVES(hit, n) ((hit)->own_tests += (n))
#else
#define RT_HOST_COUNT(ray, what, n) ((void)0)
#define RT_NODE(ray, node) (node)
#define RT_COUNT_VISIT(hit, inside) ((void)(inside))
#define RT_COUNT_BOXES(hit, n) ((void)(n))
#define RT_COUNT_LEAVES(hit, n) ((void)(n))
#endif
#define RT_COUNT_LEAF(hit) RT_COUNT_LEAVES(hit, 1u)
/* For traversals that do not know which lanes are in a node: all lanes that still search count. */
#define RT_COUNT_STEP(hit) RT_COUNT_VISIT(hit, rt_bits(RT_MASK((hit)->t >= rt_vfloat(0.0f))))

/* In debug programs, a kernel without an rt_tally counts full stacks into one number, an argument before those of the context. */
#ifdef RT_DEBUG
#define RT_OVERFLOWS_PARAM volatile global uint *overflows,
#define RT_CLEAR_OVERFLOW(hit) (hit)->overflow = 0u; /* where rt_clear_hits() is not called for every hit */
#define RT_COUNT_OVERFLOW(hit) if ((hit)->overflow != 0u) atomic_add(overflows, (hit)->overflow);
#define RT_TALLY_OVERFLOW(tally, hit) (tally)->overflow += (hit)->overflow; /* of kernels with an rt_tally */
#else
#define RT_OVERFLOWS_PARAM
#define RT_CLEAR_OVERFLOW(hit)
#define RT_COUNT_OVERFLOW(hit)
#define RT_TALLY_OVERFLOW(tally, hit)
#endif

/* `clarity check` counts what rays test if RT_STACK_OK refuses them room. It sends each ray three times in a row: the first gets
 * room as usual, the second never, the third RT_STACK_GRANTED times. One program does all three. */
#ifdef RT_STACK_GRANTED
#define RT_GRANT_PUSHES(hit, number) \
    (hit)->granted = (number) % 3u == 0u ? UINT_MAX : (number) % 3u == 1u ? 0u : RT_STACK_GRANTED;
#else
#define RT_GRANT_PUSHES(hit, number)
#endif

/* Asked before each step of a traversal's loop; see CONTRACT.md. */
#ifdef RT_STEP_BUDGET
#define RT_MAY_GO_ON(hit) ((hit)->step_budget-- > 0)
#else
#define RT_MAY_GO_ON(hit) 1
#endif

#define RT_EPS 5.9604645e-8f /* 2^-24, half an ulp of 1 */
#define RT_WIDE (1.0f + 16.0f * RT_EPS)

/* The lanes in which a component of the direction, or its reciprocal, is negative. */
#define rt_negative(v) RT_MASK((v) < rt_vfloat(0.0f))

RT_INLINE vfloat rt_safe_reciprocal(vfloat d)
{
    const vfloat tiny = rt_vfloat(1e-18f);
    const vfloat magnitude = rt_max(fabs(d), tiny);
    return rt_vfloat(1.0f) / copysign(magnitude, d);
}

/* For scenes whose coordinates are beyond 2^36, or all below 2^-30, the host defines RT_SCENE_SCALE, a power of two (scene_features.cpp). */
#ifndef RT_SCENE_SCALE
#define RT_SCENE_SCALE 1.0f
#endif
#define RT_LARGE_SCALE (RT_SCENE_SCALE > 1.0f ? RT_SCENE_SCALE : 1.0f)
/* How much a component of a direction counts as at least, so that its reciprocal times a coordinate of the scene is a float. */
#define RT_LEAST_SLOPE (8.2718061e-25f * RT_LARGE_SCALE) /* 2^-80 */
/* How far the far planes of boxes count as moved outwards: an absolute length in the space of the ray, 9.1e-13. A large scene has its scale
 * twice: both the slope above and the ways that rays go along it grow. */
#define RT_FAR_SLACK (9.0949470e-13f * RT_SCENE_SCALE * RT_LARGE_SCALE) /* 2^-40 */

/* 1 / direction, one component, finite; its sign stays: -0 is negative. The ray seems to move by less than RT_FAR_SLACK by that, over 2^40
 * lengths of its direction. */
RT_INLINE vfloat rt_slab_reciprocal(vfloat d)
{
    return rt_vfloat(1.0f) / copysign(rt_max(fabs(d), rt_vfloat(RT_LEAST_SLOPE)), d);
}

/* Fills in what boxes need of origin and direction. */
RT_INLINE void rt_prepare_for_boxes(rt_rays *r)
{
    /* The planes of a box are crossed at (plane - origin) * (1 / d). Computed as fma(1 / d, plane, -origin / d) that has an
     * absolute error of about half an ulp of origin / d and a relative one of a few ulp. Widening every interval by that much
     * keeps traversal watertight (Ize 2013, Robust BVH Ray Traversal) at no cost per node. At coordinate 0 that is nothing. So
     * far planes lie RT_FAR_SLACK farther out: a ray that runs within a face of a box, with a direction of 0 or nearly 0 across
     * it, does not seem to leave through that face. */
    r->ix = rt_slab_reciprocal(r->dx);
    r->iy = rt_slab_reciprocal(r->dy);
    r->iz = rt_slab_reciprocal(r->dz);
    const vfloat slack = rt_vfloat(8.0f * RT_EPS), out = rt_vfloat(RT_FAR_SLACK);
    const vfloat nx = -r->ox * r->ix, ny = -r->oy * r->iy, nz = -r->oz * r->iz;
    r->near_x = fma(fabs(nx), -slack, nx);
    r->near_y = fma(fabs(ny), -slack, ny);
    r->near_z = fma(fabs(nz), -slack, nz);
    r->far_x = fma(fabs(r->ix), out, fma(fabs(nx), slack, nx));
    r->far_y = fma(fabs(r->iy), out, fma(fabs(ny), slack, ny));
    r->far_z = fma(fabs(r->iz), out, fma(fabs(nz), slack, nz));
#ifdef RT_COUNT_STEPS
    r->counts = 0;
#endif
}

/* The rest. bits: the active lanes; their signs and axes decide whether the packet is coherent. */
RT_INLINE void rt_prepare_for_triangles(rt_rays *r, uint bits)
{
    r->incoherent = 0;
    /* Triangles are tested in a plane across the ray: the two axes other than the dominant one, sheared along the direction
     * (Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection). x: y, z;  y: z, x;  z: x, y. */
    const vfloat ax = fabs(r->dx), ay = fabs(r->dy), az = fabs(r->dz);
    const vmask is_z = RT_MASK(az >= ax) & RT_MASK(az >= ay), is_y = ~is_z & RT_MASK(ay >= ax), is_x = ~is_z & ~is_y;
    const vfloat along = rt_select(is_z, r->iz, rt_select(is_y, r->iy, r->ix));
    const vfloat shear_p = -along * rt_select(is_z, r->dx, rt_select(is_y, r->dz, r->dy));
    const vfloat shear_q = -along * rt_select(is_z, r->dy, rt_select(is_y, r->dx, r->dz));
#if RT_LANES == 1
    r->coherent = 1;
#else
    const uint neg_x = rt_bits(rt_negative(r->ix)) & bits, neg_y = rt_bits(rt_negative(r->iy)) & bits,
               neg_z = rt_bits(rt_negative(r->iz)) & bits;
    r->coherent = (neg_x == 0u || neg_x == bits) && (neg_y == 0u || neg_y == bits) && (neg_z == 0u || neg_z == bits);
    r->lo_x = neg_x ? 3u : 0u;
    r->lo_y = neg_y ? 4u : 1u;
    r->lo_z = neg_z ? 5u : 2u;
#endif
    const uint any_x = rt_bits(is_x) & bits, any_y = rt_bits(is_y) & bits, any_z = rt_bits(is_z) & bits;
    r->same_axis = (any_x == bits) || (any_y == bits) || (any_z == bits);
    r->kz = any_x ? 0u : any_y ? 1u : 2u;
    r->kx = r->kz == 2u ? 0u : r->kz + 1u;
    r->ky = r->kz == 0u ? 2u : r->kz - 1u;
#if RT_LANES > 1
    if (!r->same_axis)
#endif
    {
        const vint zero = rt_vint(0), one = rt_vint(1), two = rt_vint(2);
        r->axis_x = rt_select(is_z, zero, rt_select(is_y, two, one));
        r->axis_z = rt_select(is_z, two, rt_select(is_y, one, zero));
        /* The third of 0, 1, 2. Selected like the others, it is 255 in oclgrind 21.10 where it should be 1 (docs/testing.md). */
        r->axis_y = rt_vint(3) - r->axis_x - r->axis_z;
    }
    r->px = rt_select(is_z, r->ox, rt_select(is_y, r->oz, r->oy));
    r->py = rt_select(is_z, r->oy, rt_select(is_y, r->ox, r->oz));
    r->pz = rt_select(is_z, r->oz, rt_select(is_y, r->oy, r->ox));
    r->sx = shear_p;
    r->sy = shear_q;
    r->sz = along;
}

RT_INLINE void rt_prepare(rt_rays *r, uint bits)
{
    rt_prepare_for_boxes(r);
    rt_prepare_for_triangles(r, bits);
}

/* Whether at least half of the rays of a packet start more than two triangles away from the first ray, measured by the size of
 * the triangles that they start on. area: twice the area of each ray's triangle. */
#define RT_INCOHERENT 4.0f
RT_INLINE int rt_incoherent(const rt_rays *r, vfloat area, uint bits)
{
#if RT_LANES == 1
    return 0;
#else
    const uint first = rt_lowest(bits);
    const vfloat x = r->ox - rt_vfloat(((const float *)&r->ox)[first]), y = r->oy - rt_vfloat(((const float *)&r->oy)[first]),
                 z = r->oz - rt_vfloat(((const float *)&r->oz)[first]);
    const vmask away = RT_MASK(fma(x, x, fma(y, y, z * z)) > rt_vfloat(RT_INCOHERENT) * area);
    return 2u * popcount(rt_bits(away) & bits) >= popcount(bits);
#endif
}

/* Lanes in which a primitive at distance t is the nearest hit so far, or one that a list of hits wants. Of two primitives at one
 * distance the lower number wins. */
RT_INLINE vmask rt_closer(const rt_rays *r, const rt_hits *h, vfloat t, uint prim)
{
#ifdef RT_ALL_HITS
    return RT_MASK(t >= r->t_min) & RT_MASK(t <= h->t) & rt_list_wants(h->list, t, prim);
#else
    return RT_MASK(t >= r->t_min) & (RT_MASK(t < h->t) | (RT_MASK(t == h->t) & RT_MASK(rt_vint((int)prim) < h->prim)));
#endif
}

/* The last step of a slab test (Kay, Kajiya 1986, "Ray Tracing Complex Scenes"). Given the distances at which a ray meets the
 * near planes of a box (ax, ay, az) and its far planes (bx, by, bz), finds the distances *in .. *out at which it is inside the
 * box, between t_min and t. It misses the box if *in > *out. The far side is widened by the relative error of all these
 * distances. */
RT_INLINE void rt_intersect_slabs(vfloat ax, vfloat ay, vfloat az, vfloat bx, vfloat by, vfloat bz, vfloat t_min, vfloat t, vfloat *in,
                                  vfloat *out)
{
    *in = rt_max(rt_max(ax, ay), rt_max(az, t_min));
    *out = rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, t);
}

/* The lanes that enter a box before their nearest hit, given its planes as these rays meet them: near ones, then far ones.
 * *entry is the distance of entry. Rounding never loses a lane. */
RT_INLINE vmask rt_enter_planes(vfloat near_x, vfloat near_y, vfloat near_z, vfloat far_x, vfloat far_y, vfloat far_z, const rt_rays *r,
                                const rt_hits *h, vfloat *entry)
{
    RT_HOST_COUNT(r, boxes, 1u);
    const vfloat ax = fma(r->ix, near_x, r->near_x), bx = fma(r->ix, far_x, r->far_x);
    const vfloat ay = fma(r->iy, near_y, r->near_y), by = fma(r->iy, far_y, r->far_y);
    const vfloat az = fma(r->iz, near_z, r->near_z), bz = fma(r->iz, far_z, r->far_z);
    vfloat out;
    rt_intersect_slabs(ax, ay, az, bx, by, bz, r->t_min, h->t, entry, &out);
    return RT_MASK(*entry <= out);
}

/* The same for a box from lo to hi. Each lane selects its near planes by the signs of its direction. */
RT_INLINE vmask rt_enter_bounds(vfloat lo_x, vfloat lo_y, vfloat lo_z, vfloat hi_x, vfloat hi_y, vfloat hi_z, const rt_rays *r,
                                const rt_hits *h, vfloat *entry)
{
    const vmask neg_x = rt_negative(r->ix), neg_y = rt_negative(r->iy), neg_z = rt_negative(r->iz);
    return rt_enter_planes(rt_select(neg_x, hi_x, lo_x), rt_select(neg_y, hi_y, lo_y), rt_select(neg_z, hi_z, lo_z),
                           rt_select(neg_x, lo_x, hi_x), rt_select(neg_y, lo_y, hi_y), rt_select(neg_z, lo_z, hi_z), r, h, entry);
}

/* The same for a box {lo.xyz, hi.xyz} in memory. If a packet's lanes agree in sign, near and far planes are selected by address. */
RT_INLINE RT_OVERLOADED vmask rt_enter_box(const global float *box, const rt_rays *r, const rt_hits *h, vfloat *entry)
{
#if RT_LANES > 1
    if (r->coherent)
        return rt_enter_planes(rt_vfloat(box[r->lo_x]), rt_vfloat(box[r->lo_y]), rt_vfloat(box[r->lo_z]), rt_vfloat(box[3u - r->lo_x]),
                               rt_vfloat(box[5u - r->lo_y]), rt_vfloat(box[7u - r->lo_z]), r, h, entry);
#endif
    return rt_enter_bounds(rt_vfloat(box[0]), rt_vfloat(box[1]), rt_vfloat(box[2]), rt_vfloat(box[3]), rt_vfloat(box[4]),
                           rt_vfloat(box[5]), r, h, entry);
}

/* The same, and where the ray leaves the box again: `exit` is widened by rounding, and no later than hit->t. */
RT_INLINE RT_OVERLOADED vmask rt_enter_exit(const global float *box, const rt_rays *r, const rt_hits *h, vfloat *entry, vfloat *exit)
{
    RT_HOST_COUNT(r, boxes, 1u);
    const vmask neg_x = rt_negative(r->ix), neg_y = rt_negative(r->iy), neg_z = rt_negative(r->iz);
    const vfloat ax = fma(r->ix, rt_select(neg_x, rt_vfloat(box[3]), rt_vfloat(box[0])), r->near_x);
    const vfloat bx = fma(r->ix, rt_select(neg_x, rt_vfloat(box[0]), rt_vfloat(box[3])), r->far_x);
    const vfloat ay = fma(r->iy, rt_select(neg_y, rt_vfloat(box[4]), rt_vfloat(box[1])), r->near_y);
    const vfloat by = fma(r->iy, rt_select(neg_y, rt_vfloat(box[1]), rt_vfloat(box[4])), r->far_y);
    const vfloat az = fma(r->iz, rt_select(neg_z, rt_vfloat(box[5]), rt_vfloat(box[2])), r->near_z);
    const vfloat bz = fma(r->iz, rt_select(neg_z, rt_vfloat(box[2]), rt_vfloat(box[5])), r->far_z);
    rt_intersect_slabs(ax, ay, az, bx, by, bz, r->t_min, h->t, entry, exit);
    return RT_MASK(*entry <= *exit);
}

/* How far the coordinate o + d * t of a point of a ray may be from where the tests of primitives see it: the slack of boxes as a
 * length. For structures that turn a distance into a place, such as grids. */
RT_INLINE RT_OVERLOADED vfloat rt_position_slack(vfloat o, vfloat d, vfloat t)
{
    return fma(fabs(o), rt_vfloat(8.0f * RT_EPS), fma(fabs(d * t), rt_vfloat(16.0f * RT_EPS), rt_vfloat(RT_FAR_SLACK)));
}

/* Returns the lanes with rays that enter the bounds of all primitives but planes before t_max. */
RT_INLINE vmask rt_enter_scene(const constant rt_frame *frame, const rt_rays *r, vfloat t_max)
{
    vfloat entry;
    rt_hits reach;
    reach.t = t_max;
    return rt_enter_bounds(rt_vfloat(frame->bounds[0]), rt_vfloat(frame->bounds[1]), rt_vfloat(frame->bounds[2]),
                           rt_vfloat(frame->bounds[3]), rt_vfloat(frame->bounds[4]), rt_vfloat(frame->bounds[5]), r, &reach, &entry);
}

#endif
