/* cells.h -- the cells of a regular grid along one ray, and none left out. For traversals with RT_TRAVERSES_SINGLE_RAYS.
 *
 * Amanatides, Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing" (3D-DDA): of the next planes in x, y and z, the one
 * that the ray meets first decides into which neighbour it goes. As it stands in the paper, that loses rays: where two distances
 * differ by less than their rounding, the ray may be in either neighbour. So each axis has two fronts here. The front ahead goes
 * on at the earliest distance at which the ray may cross a plane, the front behind at the latest (RT_WIDE, near_x and far_x of
 * rays.h). The ray is between the fronts: mostly in one cell, near an edge in two, and in more only if the grid's cells are as
 * small as the rounding of a ray that comes from far away.
 *
 *     rt_cells cells;
 *     for (bool more = rt_first_cell(&cells, box, size, counts, ray, hit); more; more = rt_next_cell(&cells, hit->t)) ...
 *
 * visits, and counts as nodes, all cells (cells.x.at, cells.y.at, cells.z.at) that the ray enters before hit->t, in the order of their distances but
 * for those of one step. Planes are computed as box + i * size, so see "Slack" in CONTRACT.md for the builder's part. */
#ifndef RT_CELLS_H
#define RT_CELLS_H

typedef struct rt_cell_axis {
    int ahead, behind, step, last; /* the fronts; 1 or -1; the grid's last cell in that direction */
    int at, from, to;              /* the current cell; those of this step */
    float earliest, latest;        /* when the ray may leave `ahead`, and has left `behind` */
    float inverse, near, far, low, size;
} rt_cell_axis;

typedef struct rt_cells {
    rt_cell_axis x, y, z;
    float leave; /* when the ray has left the grid */
#ifdef RT_COUNT_STEPS
    rt_counts *counts;
#endif
} rt_cells;

/* The plane through which the ray leaves a cell. */
RT_INLINE float rt_cell_plane(const rt_cell_axis *a, int cell)
{
    return fma((float)(a->step > 0 ? cell + 1 : cell), a->size, a->low);
}

RT_INLINE void rt_move_ahead(rt_cell_axis *a, int cell)
{
    a->ahead = cell;
    a->earliest = cell == a->last ? INFINITY : fma(a->inverse, rt_cell_plane(a, cell), a->near);
}

/* Leaves the cells that the ray has left for sure at `t`. */
RT_INLINE void rt_move_behind(rt_cell_axis *a, float t)
{
    while (a->behind != a->ahead && a->latest < t) {
        a->behind += a->step;
        a->latest = fma(a->inverse, rt_cell_plane(a, a->behind), a->far) * RT_WIDE;
    }
    a->at = a->from = a->behind;
    a->to = a->ahead;
}

/* Enters the next cell of an axis. */
RT_INLINE void rt_enter_cell(rt_cell_axis *a)
{
    rt_move_ahead(a, a->ahead + a->step);
    a->at = a->from = a->to = a->ahead;
}

RT_INLINE int rt_cell_of(const rt_cell_axis *a, float coordinate, float most)
{
    const float cell = (coordinate - a->low) / a->size;
    return (int)rt_min(rt_max(cell, 0.0f), most);
}

RT_INLINE void rt_begin_axis(rt_cell_axis *a, float low, float size, uint count, float o, float d, float inverse, float near, float far,
                             float t)
{
    a->low = low, a->size = size, a->inverse = inverse, a->near = near, a->far = far;
    a->step = inverse < 0.0f ? -1 : 1;
    a->last = inverse < 0.0f ? 0 : (int)count - 1;
    const float slack = copysign((float)rt_position_slack(o, d, t), inverse), coordinate = fma(d, t, o), most = (float)count - 1.0f;
    a->behind = rt_cell_of(a, coordinate - slack, most);
    a->latest = fma(inverse, rt_cell_plane(a, a->behind), far) * RT_WIDE;
    rt_move_ahead(a, rt_cell_of(a, coordinate + slack, most));
    a->at = a->from = a->behind;
    a->to = a->ahead;
}

/* Finds the cells in which the ray enters the grid. box, size, counts: the grid's box, the size of its cells, and their numbers.
 * Returns false if the ray misses it. */
RT_INLINE bool rt_first_cell(rt_cells *c, const global float *box, const global float *size, const global uint *counts,
                             const rt_single_ray *ray, const rt_single_hit *hit)
{
    float t, leave;
    if (!rt_enter_exit(box, ray, hit, &t, &leave)) return false;
    c->leave = rt_min(leave, MAXFLOAT);
    rt_begin_axis(&c->x, box[0], size[0], counts[0], ray->ox, ray->dx, ray->ix, ray->near_x, ray->far_x, t);
    rt_begin_axis(&c->y, box[1], size[1], counts[1], ray->oy, ray->dy, ray->iy, ray->near_y, ray->far_y, t);
    rt_begin_axis(&c->z, box[2], size[2], counts[2], ray->oz, ray->dz, ray->iz, ray->near_z, ray->far_z, t);
#ifdef RT_COUNT_STEPS
    c->counts = ray->counts;
#endif
    RT_HOST_COUNT(c, nodes, 1u);
    return true;
}

RT_INLINE bool rt_go_to_next_cell(rt_cells *c, float t)
{
    rt_cell_axis *const x = &c->x, *const y = &c->y, *const z = &c->z;
    if (x->at != x->to) return x->at += x->step, true;
    x->at = x->from;
    if (y->at != y->to) return y->at += y->step, true;
    y->at = y->from;
    if (z->at != z->to) return z->at += z->step, true;

    const float next = rt_min(rt_min(x->earliest, y->earliest), z->earliest);
    if (!(next <= rt_min(c->leave, t))) return false;
    rt_move_behind(x, next);
    rt_move_behind(y, next);
    rt_move_behind(z, next);
    if (x->earliest == next)
        rt_enter_cell(x);
    else if (y->earliest == next)
        rt_enter_cell(y);
    else
        rt_enter_cell(z);
    return true;
}

/* Goes to the next cell. t: the ray's nearest hit so far. Returns false if there is none before it. */
RT_INLINE bool rt_next_cell(rt_cells *c, float t)
{
    if (!rt_go_to_next_cell(c, t)) return false;
    RT_HOST_COUNT(c, nodes, 1u);
    return true;
}

#endif
