/* light_tree.h -- picks an emitter for a point of a surface by its power, its distance and how both face each other.
 *
 * Conty Estevez, Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", without the splitting. 64 bytes a node,
 * two nodes a light, no stack. Good where many lights are near some of what they light and far from the rest. Each pick costs two bounds
 * a level, and so does the density of what a ray finds: the path from the leaf to the root gives it. Occlusion is not known.
 *
 * A normal of length 0 stands for a surface that lets light through: it is lit from both sides. */
#ifndef RT_LIGHT_TREE_H
#define RT_LIGHT_TREE_H
#ifdef RT_LIGHT_TREE
#define RT_BY_TREE(code) code
#define RT_TREE_ARG(more) , more

/* Distances below its root count as this: a point may lie on a light without size. */
#define RT_TREE_NEAREST2 1e-20f

/* Where a surface is lit, and its unit normal. */
typedef struct rt_lit_point {
    float at[3], normal[3];
} rt_lit_point;

RT_INLINE float rt_sine_of(float cosine) { return sqrt(max(fma(-cosine, cosine, 1.0f), 0.0f)); }

/* The cosine of an angle that is made smaller by another, but not below 0. */
RT_INLINE float rt_cosine_less(float sine, float cosine, float less_sine, float less_cosine)
{
    return cosine > less_cosine ? 1.0f : fma(cosine, less_cosine, sine * less_sine);
}

/* Up to a factor, the irradiance at a point that the emitters of a node may cause. 0 only if they can cause none. */
RT_INLINE float rt_node_importance(const global rt_light_node *node, const rt_lit_point *point)
{
    float d2 = 0.0f, r2 = 0.0f, along = 0.0f, facing = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const float half_size = 0.5f * (node->upper[k] - node->lower[k]), to = node->lower[k] + half_size - point->at[k];
        r2 = fma(half_size, half_size, r2);
        d2 = fma(to, to, d2);
        along = fma(node->axis[k], to, along);
        facing = fma(point->normal[k], to, facing);
    }
    /* The mean of 1 / distance^2 of what fills a ball, in its middle, on its surface and far away. */
    const float third = r2 * (1.0f / 3.0f), importance = node->intensity / max(max(d2 - third, third), RT_TREE_NEAREST2);
    if (d2 <= r2) return importance;
    /* The box lies within a cone around the direction to its middle. */
    const float inverse = 1.0f / sqrt(max(d2, 1e-36f)), cone_sine = min(sqrt(r2) * inverse, 1.0f), cone_cosine = rt_sine_of(cone_sine);
    float cosine = clamp(-along * inverse, -1.0f, 1.0f);
    if (node->two_sided != 0u) cosine = fabs(cosine);
    const float off_axis = rt_cosine_less(rt_sine_of(cosine), cosine, rt_sine_of(node->cos_spread), node->cos_spread);
    const float leaves = rt_cosine_less(rt_sine_of(off_axis), off_axis, cone_sine, cone_cosine);
    if (leaves <= node->cos_reach) return 0.0f;
    const float met = clamp(facing * inverse, -1.0f, 1.0f);
    const bool sided = point->normal[0] != 0.0f || point->normal[1] != 0.0f || point->normal[2] != 0.0f;
    const float arrives = sided ? rt_cosine_less(rt_sine_of(met), met, cone_sine, cone_cosine) : 1.0f;
    return importance * leaves * max(arrives, 0.0f);
}

/* The share of the first of two children; below 0 if neither can light the point. */
RT_INLINE float rt_first_share(const global rt_light_node *children, const rt_lit_point *point)
{
    const float first = rt_node_importance(children, point), sum = first + rt_node_importance(children + 1, point);
    return sum > 0.0f ? first / sum : -1.0f;
}

/* Picks an emitter by a number of [0, 1), which is stretched again at each node. *chance: its probability, 0 if none can light the
 * point. */
RT_INLINE uint rt_descend_lights(const rt_ctx *ctx, const rt_lit_point *point, float number, float *chance)
{
    const global rt_light_node *nodes = ctx->light_nodes, *node = nodes;
    *chance = 1.0f;
    while (node->child != RT_NONE) {
        const global rt_light_node *children = nodes + node->child;
        const float share = rt_first_share(children, point);
        if (share < 0.0f) {
            *chance = 0.0f;
            return 0u;
        }
        const bool first = number < share;
        const float mine = first ? share : 1.0f - share;
        number = min((first ? number : number - share) / mine, 0.99999994f);
        *chance *= mine;
        node = first ? children : children + 1;
    }
    return node->emitter;
}

/* The probability with which rt_descend_lights() picks the emitter of a leaf. */
RT_INLINE float rt_chance_of_leaf(const rt_ctx *ctx, const rt_lit_point *point, uint leaf)
{
    const global rt_light_node *nodes = ctx->light_nodes;
    float chance = 1.0f;
    for (uint node = leaf, parent; (parent = nodes[node].parent) != RT_NONE; node = parent) {
        const uint first = nodes[parent].child;
        const float share = rt_first_share(nodes + first, point);
        if (share < 0.0f) return 0.0f;
        chance *= node == first ? share : 1.0f - share;
    }
    return chance;
}

/* Points of all lanes: six columns of numbers. */
RT_INLINE void rt_store_lit_points(rt_vec at, rt_vec normal, float *columns)
{
    rt_store(at.x, columns), rt_store(at.y, columns + RT_LANES), rt_store(at.z, columns + 2 * RT_LANES);
    rt_store(normal.x, columns + 3 * RT_LANES), rt_store(normal.y, columns + 4 * RT_LANES), rt_store(normal.z, columns + 5 * RT_LANES);
}
RT_INLINE rt_lit_point rt_lit_point_of(const float *columns, uint lane)
{
    rt_lit_point point;
    for (uint k = 0; k < 3u; ++k) {
        point.at[k] = columns[k * RT_LANES + lane];
        point.normal[k] = columns[(k + 3u) * RT_LANES + lane];
    }
    return point;
}
/* The probability with which an emitter is picked for a point. */
RT_INLINE float rt_pick_of(const rt_ctx *ctx, const global rt_emitter *emitter, const rt_lit_point *point)
{
    return emitter->leaf == RT_NONE ? emitter->pick : emitter->pick * rt_chance_of_leaf(ctx, point, emitter->leaf);
}
/* The same for points of all lanes, of which the bits say which count. */
RT_INLINE vfloat rt_picks_of(const rt_ctx *ctx, const global rt_emitter *emitter, rt_vec at, rt_vec normal, uint bits)
{
    float points[6 * RT_LANES], picks[RT_LANES];
    rt_store_lit_points(at, normal, points);
    for (uint l = 0; l < RT_LANES; ++l) {
        const rt_lit_point point = rt_lit_point_of(points, l);
        picks[l] = bits >> l & 1u ? rt_pick_of(ctx, emitter, &point) : 0.0f;
    }
    return rt_load(picks);
}
#else
#define RT_BY_TREE(code)
#define RT_TREE_ARG(more)
#endif

#endif
