/* single_ray.h -- the rays of a packet one at a time, as arrays.
 *
 * The rays of an incoherent packet are traced separately. Extracting a lane from a vector at each step would cost more than
 * storing all lanes once.
 *
 * RT_AT(r->sx, l) is the number of lane l. In programs of one lane rt_single_rays and rt_single_hits are rt_rays and rt_hits
 * themselves, and l is 0. The numbers are those of the packet, so a ray's hit does not depend on the rays traced with it. */
#ifndef RT_SINGLE_RAY_H
#define RT_SINGLE_RAY_H

#if RT_LANES == 1

#define RT_AT(field, l) (field)
#define rt_single_rays rt_rays
#define rt_single_hits rt_hits

#else

#define RT_AT(field, l) (field)[l]

/* The members of rt_rays. */
typedef struct rt_single_rays {
    float ox[RT_LANES], oy[RT_LANES], oz[RT_LANES], dx[RT_LANES], dy[RT_LANES], dz[RT_LANES], t_min[RT_LANES];
    float ix[RT_LANES], iy[RT_LANES], iz[RT_LANES];
    float near_x[RT_LANES], near_y[RT_LANES], near_z[RT_LANES], far_x[RT_LANES], far_y[RT_LANES], far_z[RT_LANES];
    float px[RT_LANES], py[RT_LANES], pz[RT_LANES], sx[RT_LANES], sy[RT_LANES], sz[RT_LANES];
    int kx[RT_LANES], ky[RT_LANES], kz[RT_LANES]; /* for each ray, since a packet may have several dominant axes */
#ifdef RT_COUNT_STEPS
    rt_counts *counts; /* of the packet */
#endif
} __attribute__((aligned(64))) rt_single_rays;

/* The members of rt_hits. */
typedef struct rt_single_hits {
    float t[RT_LANES], u[RT_LANES], v[RT_LANES], nx[RT_LANES], ny[RT_LANES], nz[RT_LANES];
    int leaf[RT_LANES], prim[RT_LANES], instance[RT_LANES];
#ifdef RT_ALL_HITS
    rt_hit_list *list;
#endif
} __attribute__((aligned(64))) rt_single_hits;

RT_INLINE void rt_spread_rays(const rt_rays *from, rt_single_rays *to)
{
    rt_store(from->ox, to->ox), rt_store(from->oy, to->oy), rt_store(from->oz, to->oz);
    rt_store(from->dx, to->dx), rt_store(from->dy, to->dy), rt_store(from->dz, to->dz);
    rt_store(from->t_min, to->t_min);
    rt_store(from->ix, to->ix), rt_store(from->iy, to->iy), rt_store(from->iz, to->iz);
    rt_store(from->near_x, to->near_x), rt_store(from->near_y, to->near_y), rt_store(from->near_z, to->near_z);
    rt_store(from->far_x, to->far_x), rt_store(from->far_y, to->far_y), rt_store(from->far_z, to->far_z);
    rt_store(from->px, to->px), rt_store(from->py, to->py), rt_store(from->pz, to->pz);
    rt_store(from->sx, to->sx), rt_store(from->sy, to->sy), rt_store(from->sz, to->sz);
    rt_store(from->same_axis ? rt_vint((int)from->kx) : from->axis_x, to->kx);
    rt_store(from->same_axis ? rt_vint((int)from->ky) : from->axis_y, to->ky);
    rt_store(from->same_axis ? rt_vint((int)from->kz) : from->axis_z, to->kz);
#ifdef RT_COUNT_STEPS
    to->counts = from->counts;
#endif
}

RT_INLINE void rt_spread_hits(const rt_hits *from, rt_single_hits *to)
{
    rt_store(from->t, to->t), rt_store(from->u, to->u), rt_store(from->v, to->v);
    rt_store(from->nx, to->nx), rt_store(from->ny, to->ny), rt_store(from->nz, to->nz);
    rt_store(from->leaf, to->leaf), rt_store(from->prim, to->prim), rt_store(from->instance, to->instance);
#ifdef RT_ALL_HITS
    to->list = from->list;
#endif
}

/* Makes rt_hits of the arrays. The counters of `to` keep their values. */
RT_INLINE void rt_gather_hits(const rt_single_hits *from, rt_hits *to)
{
    to->t = rt_load(from->t), to->u = rt_load(from->u), to->v = rt_load(from->v);
    to->nx = rt_load(from->nx), to->ny = rt_load(from->ny), to->nz = rt_load(from->nz);
    to->leaf = rt_load(from->leaf), to->prim = rt_load(from->prim), to->instance = rt_load(from->instance);
#ifdef RT_ALL_HITS
    to->list = from->list;
#endif
}

#endif
#endif
