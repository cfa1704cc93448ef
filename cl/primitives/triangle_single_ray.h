/* triangle_single_ray.h -- the test of triangle.h for one ray of a packet: the same operations, so the same bits.
 *
 * triangle_row.h has seen that the ray passes between the edges. What is left to decide nearly always holds, so it is left to
 * branches. The distance comes first, for it may not hold. A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_hit_triangle_single_ray)(const global rt_packed_prim *leaf, uint at, const rt_single_rays *r, uint l, rt_single_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    const int kx = (int)RT_AT(r->kx, l), ky = (int)RT_AT(r->ky, l), kz = (int)RT_AT(r->kz, l);
    const float sx = RT_AT(r->sx, l), sy = RT_AT(r->sy, l), sz = RT_AT(r->sz, l);
    const float az = RT_AT(r->pz, l) - leaf->a[kz], bz = RT_AT(r->pz, l) - leaf->b[kz], cz = RT_AT(r->pz, l) - leaf->c[kz];
    const float a_x = leaf->a[0], a_y = leaf->a[1], a_z = leaf->a[2];
    float nx, ny, nz;
    rt_triangle_normal(a_x, a_y, a_z, leaf->b[0], leaf->b[1], leaf->b[2], leaf->c[0], leaf->c[1], leaf->c[2], &nx, &ny, &nz);
    const float facing = RT_DOT(nx, ny, nz, RT_AT(r->dx, l), RT_AT(r->dy, l), RT_AT(r->dz, l));
    const float height = RT_DOT(nx, ny, nz, a_x - RT_AT(r->ox, l), a_y - RT_AT(r->oy, l), a_z - RT_AT(r->oz, l));
    const float ta = -az * sz, tb = -bz * sz, tc = -cz * sz;
    const float t = RT_PLANE_DISTANCE(height, facing, RT_MIN3(ta, tb, tc), RT_MAX3(ta, tb, tc));
    /* As rt_closer. */
    if (!(t >= RT_AT(r->t_min, l) && t <= RT_AT(h->t, l))) return;
#ifdef RT_ALL_HITS
    if (!rt_list_wants_one(h->list, l, t, leaf->prim)) return;
#else
    if (t == RT_AT(h->t, l) && (int)leaf->prim >= RT_AT(h->prim, l)) return;
#endif

#define RT_PROJECT(corner, z, x, y)                                                                                            \
    const float x = RT_SHEARED(sx, z, RT_AT(r->px, l), leaf->corner[kx]), y = RT_SHEARED(sy, z, RT_AT(r->py, l), leaf->corner[ky]);
    RT_PROJECT(a, az, ax, ay)
    RT_PROJECT(b, bz, bx, by)
    RT_PROJECT(c, cz, cx, cy)
#undef RT_PROJECT
    if (!(RT_MIN3(ax, bx, cx) <= 0.0f && RT_MAX3(ax, bx, cx) >= 0.0f)) return;
    if (!(RT_MIN3(ay, by, cy) <= 0.0f && RT_MAX3(ay, by, cy) >= 0.0f)) return;
    const float u = RT_EDGE(cx, cy, bx, by);
    const float v = RT_EDGE(ax, ay, cx, cy);
    const float w = RT_EDGE(bx, by, ax, ay);
    if (!(RT_MIN3(u, v, w) >= 0.0f || RT_MAX3(u, v, w) <= 0.0f)) return;
    const float det = u + v + w;
    if (det == 0.0f) return;
#if RT_ANY_HIT
    RT_AT(h->t, l) = -1.0f;
#elif defined(RT_ALL_HITS)
    const float scale = 1.0f / det;
    RT_AT(h->t, l) = rt_list_add_one(h->list, l, t, v * scale, w * scale, leaf->prim);
#else
    const float scale = 1.0f / det;
    RT_AT(h->t, l) = t;
    RT_AT(h->u, l) = v * scale;
    RT_AT(h->v, l) = w * scale;
    RT_AT(h->nx, l) = nx;
    RT_AT(h->ny, l) = ny;
    RT_AT(h->nz, l) = nz;
    RT_AT(h->leaf, l) = (int)at;
    RT_AT(h->prim, l) = (int)leaf->prim;
    RT_AT(h->instance, l) = -1;
#endif
}
