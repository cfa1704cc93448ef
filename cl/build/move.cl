/* move.cl -- the primitives of a scene that moves: leaves and boxes of one group follow the vertices and transforms.
 *
 * A triangle moves about 150 B through memory: 12 of vertex numbers, its vertices, its leaf both ways, its box. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF /* the same boxes as the host's build_scene.cpp */

/* Where an instance is. 112 B. Rows of 3x4 matrices. */
typedef struct rt_placement {
    float world_from_object[12], object_from_world[12];
    uint hidden, pad[3]; /* of rt_instance */
} rt_placement;

RT_INLINE void rt_grow(rt_block *box, const float *p)
{
    for (uint k = 0u; k < 3u; ++k) box->lo[k] = min(box->lo[k], p[k]), box->hi[k] = max(box->hi[k], p[k]);
}
/* Room for rounding, since kernels compute with what is in the box in another order. */
RT_INLINE void rt_widen(rt_block *box)
{
    for (uint k = 0u; k < 3u; ++k) {
        const float room = 1e-6f * max(fabs(box->lo[k]), fabs(box->hi[k]));
        box->lo[k] -= room;
        box->hi[k] += room;
    }
}

/* The box in the world of an instance of what is in `box`: placed_box() of build_scene.cpp, which explains it. */
RT_INLINE rt_block rt_placed_box(rt_block box, const global rt_placement *placed)
{
    const double rounding = 8.0 * 0x1p-24, gamma = rounding / (1.0 - rounding);
    double lo[3], hi[3], farthest[3], error[3];
    for (uint k = 0u; k < 3u; ++k) {
        lo[k] = hi[k] = placed->world_from_object[4u * k + 3u];
        for (uint j = 0u; j < 3u; ++j) {
            const double m = placed->world_from_object[4u * k + j], a = m * box.lo[j], b = m * box.hi[j];
            lo[k] += min(a, b);
            hi[k] += max(a, b);
        }
        farthest[k] = max(fabs(lo[k]), fabs(hi[k]));
    }
    for (uint j = 0u; j < 3u; ++j) {
        double terms = fabs((double)placed->object_from_world[4u * j + 3u]);
        for (uint k = 0u; k < 3u; ++k) terms += fabs((double)placed->object_from_world[4u * j + k]) * farthest[k];
        error[j] = gamma * terms;
    }
    for (uint k = 0u; k < 3u; ++k) {
        double room = 0.0;
        for (uint j = 0u; j < 3u; ++j) room += fabs((double)placed->world_from_object[4u * k + j]) * error[j];
        box.lo[k] = convert_float_rtn(lo[k] - room);
        box.hi[k] = convert_float_rtp(hi[k] + room);
    }
    rt_widen(&box);
    return box;
}

/* Writes the leaves first .. first + count - 1 and their boxes (from 0 on). Triangles move if `moves`: corners[ref] are the numbers of
 * their vertices. Instances follow their placement and the box of their group. Positions and boxes are in the group's space. */
RT_BUILD_KERNEL move_leaves(global rt_packed_prim *leaves, uint first, uint count, uint each, uint moves,
                            const global rt_triangle *corners, const global float *positions,
                            const global rt_placement *placements, const global uint *group_of_instance,
                            const global rt_block *group_boxes, global rt_instance *instances,
                            const global rt_polygon *polygons, const global float *polygon_corners, global rt_build_box *boxes)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        global rt_packed_prim *const leaf = leaves + first + i;
        const uint ref = leaf->ref, index = RT_REF_INDEX(ref), kind = RT_REF_KIND(ref);
        rt_block box = rt_no_block();
        if (kind == RT_REF_TRIANGLE) {
            float at[3][3];
            if (moves) {
                for (uint c = 0u; c < 3u; ++c)
                    for (uint k = 0u; k < 3u; ++k) at[c][k] = positions[3ul * corners[index].v[c] + k];
                for (uint k = 0u; k < 3u; ++k) leaf->a[k] = at[0][k], leaf->b[k] = at[1][k], leaf->c[k] = at[2][k];
            } else {
                for (uint k = 0u; k < 3u; ++k) at[0][k] = leaf->a[k], at[1][k] = leaf->b[k], at[2][k] = leaf->c[k];
            }
            for (uint c = 0u; c < 3u; ++c) rt_grow(&box, at[c]);
        } else if (kind == RT_REF_SPHERE) {
            for (uint k = 0u; k < 3u; ++k) {
                box.lo[k] = leaf->a[k] - leaf->b[0];
                box.hi[k] = leaf->a[k] + leaf->b[0];
            }
            rt_widen(&box);
        } else if (kind == RT_REF_POLYGON) {
            for (uint c = 0u; c < polygons[index].count; ++c) {
                float at[3];
                for (uint k = 0u; k < 3u; ++k) at[k] = polygon_corners[3ul * (polygons[index].first + c) + k];
                rt_grow(&box, at);
            }
            rt_widen(&box);
        } else {
            if (kind == RT_REF_INSTANCE) {
                const rt_block placed = rt_placed_box(group_boxes[group_of_instance[index]], placements + index);
                for (uint k = 0u; k < 12u; ++k)
                    instances[index].object_from_world[k] = placements[index].object_from_world[k];
                instances[index].hidden = placements[index].hidden;
                for (uint k = 0u; k < 3u; ++k) leaf->a[k] = placed.lo[k], leaf->b[k] = placed.hi[k];
            }
            for (uint k = 0u; k < 3u; ++k) box.lo[k] = leaf->a[k], box.hi[k] = leaf->b[k];
        }
        /* A transform may have made a coordinate infinite or no number: the box is then as large as it can be. */
        rt_build_box prim;
        for (uint k = 0u; k < 3u; ++k) {
            prim.lo[k] = min(max(box.lo[k], -FLT_MAX), FLT_MAX);
            prim.hi[k] = max(min(box.hi[k], FLT_MAX), -FLT_MAX);
        }
        prim.ref = ref;
        prim.mesh = 0u;
        boxes[i] = prim;
    }
}

/* Writes leaves in another order: place i of the group receives what was at order[i]. */
RT_BUILD_KERNEL order_leaves(const global rt_packed_prim *from, global rt_packed_prim *to, const global uint *order, uint first,
                             uint count, uint each)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) to[first + i] = from[first + order[i]];
}

/* The box of a whole group, from its blocks. */
RT_BUILD_KERNEL keep_group_box(const global rt_block *blocks, uint count, uint group, global rt_block *group_boxes)
{
    if (RT_ITEM == 0u) group_boxes[group] = rt_box_of_range(blocks, count, 0u, count);
}

/* parts[g]: the sum of the costs that work-group g has. */
RT_BUILD_KERNEL add_costs(const global float *costs, uint count, uint each, global float *parts)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    float sum = 0.0f;
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) sum += costs[i];
#if RT_GROUP > 1
    local float shared[RT_GROUP];
    shared[RT_ITEM] = sum;
    RT_LOCAL_BARRIER();
    for (uint step = RT_GROUP / 2u; step > 0u; step /= 2u) {
        if (RT_ITEM < step) shared[RT_ITEM] += shared[RT_ITEM + step];
        RT_LOCAL_BARRIER();
    }
    sum = shared[0];
#endif
    if (RT_ITEM == 0u) parts[RT_GROUP_NUMBER] = sum;
}

/* cost[group]: the expected cost of a ray that hits the box of the group; 0: no ray hits a point or a line. */
RT_BUILD_KERNEL keep_cost(const global float *parts, uint count, uint group, const global rt_block *group_boxes,
                          global float *cost)
{
    if (RT_ITEM != 0u) return;
    float sum = 0.0f;
    for (uint i = 0u; i < count; ++i) sum += parts[i];
    const float area = rt_block_area(group_boxes[group]);
    cost[group] = area > 0.0f ? sum / area : 0.0f;
}
