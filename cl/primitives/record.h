/* record.h -- stores a hit in the lanes `closer`, in which a primitive test found the nearest hit so far, or one
 * for the list of all hits. A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_record)(rt_hits *h, vmask closer, vfloat t, vfloat u, vfloat v, vfloat nx, vfloat ny, vfloat nz, int leaf,
                                uint prim)
{
#if RT_ANY_HIT
    h->t = rt_select(closer, rt_vfloat(-1.0f), h->t);
#elif defined(RT_ALL_HITS)
    rt_list_add(h->list, closer, t, u, v, prim);
    h->t = rt_select(closer, h->list->t[RT_ALL_HITS - 1u], h->t);
#else
    h->t = rt_select(closer, t, h->t);
    h->u = rt_select(closer, u, h->u);
    h->v = rt_select(closer, v, h->v);
    h->nx = rt_select(closer, nx, h->nx);
    h->ny = rt_select(closer, ny, h->ny);
    h->nz = rt_select(closer, nz, h->nz);
    h->leaf = rt_select(closer, rt_vint(leaf), h->leaf);
    h->prim = rt_select(closer, rt_vint((int)prim), h->prim);
    h->instance = rt_select(closer, rt_vint(-1), h->instance);
#endif
}
