/* triangle_single_ray.h -- triangle.h for one ray of a packet: the same operations, so the same bits. triangle_row.h has seen that the
 * ray passes between the edges, so what is left to decide nearly always holds and is left to branches; how far away the hit is
 * comes first, which may not. A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_hit_triangle_single_ray)(const global rt_packed_prim *leaf, uint at, const rt_single_rays *r, uint l, rt_single_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    const int kx = (int)RT_AT(r->kx, l), ky = (int)RT_AT(r->ky, l), kz = (int)RT_AT(r->kz, l);
    const float sx = RT_AT(r->sx, l), sy = RT_AT(r->sy, l), sz = RT_AT(r->sz, l);
    const float az = RT_AT(r->pz, l) - leaf->a[kz], bz = RT_AT(r->pz, l) - leaf->b[kz], cz = RT_AT(r->pz, l) - leaf->c[kz];
    const float a_x = leaf->a[0], a_y = leaf->a[1], a_z = leaf->a[2];
    const float e1x = leaf->b[0] - a_x, e1y = leaf->b[1] - a_y, e1z = leaf->b[2] - a_z;
    const float e2x = leaf->c[0] - a_x, e2y = leaf->c[1] - a_y, e2z = leaf->c[2] - a_z;
    const float nx = e1y * e2z - e1z * e2y, ny = e1z * e2x - e1x * e2z, nz = e1x * e2y - e1y * e2x;
    const float facing = fma(nx, RT_AT(r->dx, l), fma(ny, RT_AT(r->dy, l), nz * RT_AT(r->dz, l)));
    const float height = fma(nx, a_x - RT_AT(r->ox, l), fma(ny, a_y - RT_AT(r->oy, l), nz * (a_z - RT_AT(r->oz, l))));
    const float ta = -az * sz, tb = -bz * sz, tc = -cz * sz;
    const float t = rt_min(rt_max(height / facing, rt_min(rt_min(ta, tb), tc)), rt_max(rt_max(ta, tb), tc));
    /* As rt_closer. */
    if (!(t >= RT_AT(r->t_min, l) && t <= RT_AT(h->t, l))) return;
    if (t == RT_AT(h->t, l) && (int)leaf->prim >= RT_AT(h->prim, l)) return;

    const float ax = fma(sx, az, RT_AT(r->px, l) - leaf->a[kx]), ay = fma(sy, az, RT_AT(r->py, l) - leaf->a[ky]);
    const float bx = fma(sx, bz, RT_AT(r->px, l) - leaf->b[kx]), by = fma(sy, bz, RT_AT(r->py, l) - leaf->b[ky]);
    const float cx = fma(sx, cz, RT_AT(r->px, l) - leaf->c[kx]), cy = fma(sy, cz, RT_AT(r->py, l) - leaf->c[ky]);
    if (!(rt_min(rt_min(ax, bx), cx) <= 0.0f && rt_max(rt_max(ax, bx), cx) >= 0.0f)) return;
    if (!(rt_min(rt_min(ay, by), cy) <= 0.0f && rt_max(rt_max(ay, by), cy) >= 0.0f)) return;
    const float u = cx * by - cy * bx;
    const float v = ax * cy - ay * cx;
    const float w = bx * ay - by * ax;
    if (!(rt_min(rt_min(u, v), w) >= 0.0f || rt_max(rt_max(u, v), w) <= 0.0f)) return;
    const float det = u + v + w;
    if (det == 0.0f) return;
#if RT_ANY_HIT
    RT_AT(h->t, l) = -1.0f;
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
