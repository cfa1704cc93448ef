/* hit_list.h -- the nearest hits of the rays of all lanes, for programs that ask for all hits of a ray (RT_ALL_HITS: how many a
 * list holds).
 *
 * Gribble, Naik, Wald 2014, "Multi-Hit Ray Traversal", JCGT 3 (1): a test that hits does not end the search. It enters the hit into
 * a list in order, and the ray becomes no shorter than the last hit of a full list. So a traversal need not know of it. Hits are
 * ordered by t, and at one t by the primitive's number. A primitive that a structure names twice enters once, because both tests
 * compute the same t. Rays with a full list are traced again for the hits `after` its last one. */
#ifndef RT_HIT_LIST_H
#define RT_HIT_LIST_H

typedef struct rt_hit_list {
    vfloat t[RT_ALL_HITS], u[RT_ALL_HITS], v[RT_ALL_HITS]; /* free places have the ray's t_max, and the number -1: no hit comes after */
    vint prim[RT_ALL_HITS], instance[RT_ALL_HITS];
    vfloat after_t; /* the hits up to this one are not wanted */
    vint after_prim;
    /* While the mesh of an instance is traversed: the number of its first primitive, and the index of the instance. Else 0 and -1. */
    int first_prim, inside;
} rt_hit_list;

/* Whether the hit a comes before the hit b. */
RT_INLINE vmask rt_precedes(vfloat a_t, vint a_prim, vfloat b_t, vint b_prim)
{
    return RT_MASK(a_t < b_t) | (RT_MASK(a_t == b_t) & RT_MASK(a_prim < b_prim));
}

RT_INLINE void rt_clear_list(rt_hit_list *list, vfloat t_max, vfloat after_t, vint after_prim)
{
    for (uint i = 0; i < RT_ALL_HITS; ++i) {
        list->t[i] = t_max;
        list->u[i] = list->v[i] = rt_vfloat(0.0f);
        list->prim[i] = list->instance[i] = rt_vint(-1);
    }
    list->after_t = after_t;
    list->after_prim = after_prim;
    list->first_prim = 0;
    list->inside = -1;
}

/* The lanes whose lists take a hit at t. prim: the primitive's number within the mesh, or within the world. */
RT_INLINE vmask rt_list_wants(const rt_hit_list *list, vfloat t, uint prim)
{
    const vint number = rt_vint(list->first_prim + (int)prim);
    return rt_precedes(list->after_t, list->after_prim, t, number) &
           rt_precedes(t, number, list->t[RT_ALL_HITS - 1u], list->prim[RT_ALL_HITS - 1u]);
}

/* Enters it in these lanes, in order, unless it is there. */
RT_INLINE void rt_list_add(rt_hit_list *list, vmask lanes, vfloat t, vfloat u, vfloat v, uint prim)
{
    const vint number = rt_vint(list->first_prim + (int)prim), instance = rt_vint(list->inside);
    for (uint i = 0; i < RT_ALL_HITS; ++i) lanes &= ~(RT_MASK(list->t[i] == t) & RT_MASK(list->prim[i] == number));
    for (uint i = RT_ALL_HITS; i-- > 0u;) {
        const uint before = i > 0u ? i - 1u : 0u;
        const vmask moves = lanes & rt_precedes(t, number, list->t[i], list->prim[i]);
        const vmask takes = i > 0u ? moves & ~rt_precedes(t, number, list->t[before], list->prim[before]) : moves;
        list->t[i] = rt_select(moves, rt_select(takes, t, list->t[before]), list->t[i]);
        list->u[i] = rt_select(moves, rt_select(takes, u, list->u[before]), list->u[i]);
        list->v[i] = rt_select(moves, rt_select(takes, v, list->v[before]), list->v[i]);
        list->prim[i] = rt_select(moves, rt_select(takes, number, list->prim[before]), list->prim[i]);
        list->instance[i] = rt_select(moves, rt_select(takes, instance, list->instance[before]), list->instance[i]);
    }
}

/* The same for a ray of a packet that is traced alone. */
RT_INLINE int rt_list_wants_one(const rt_hit_list *list, uint lane, float t, uint prim)
{
    return (int)(rt_bits(rt_list_wants(list, rt_vfloat(t), prim)) >> lane & 1u);
}

RT_INLINE float rt_list_add_one(rt_hit_list *list, uint lane, float t, float u, float v, uint prim)
{
    rt_list_add(list, RT_MASK(rt_lane_index() == rt_vint((int)lane)), rt_vfloat(t), rt_vfloat(u), rt_vfloat(v), prim);
    return ((const float *)&list->t[RT_ALL_HITS - 1u])[lane];
}

#endif
