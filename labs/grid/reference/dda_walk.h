/* dda_walk.h -- our solution of the lab: Amanatides, Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing". */

int dda_first(dda_walk *walk)
{
    for (int k = 0; k < 3; ++k) {
        const float point = walk->point[k], direction = walk->direction[k];
        walk->cell[k] = clamp((int)floor(point), 0, walk->cells[k] - 1);
        walk->step[k] = direction < 0.0f ? -1 : 1;
        walk->delta[k] = direction == 0.0f ? INFINITY : fabs(1.0f / direction);
        const float plane = (float)(direction < 0.0f ? walk->cell[k] : walk->cell[k] + 1);
        walk->next[k] = direction == 0.0f ? INFINITY : (plane - point) / direction;
    }
    return 1;
}

int dda_next(dda_walk *walk, float nearest)
{
    int k = walk->next[0] < walk->next[1] ? 0 : 1;
    if (walk->next[2] < walk->next[k]) k = 2;
    if (!(walk->next[k] <= nearest)) return 0;
    walk->cell[k] += walk->step[k];
    walk->next[k] += walk->delta[k];
    return 1;
}
