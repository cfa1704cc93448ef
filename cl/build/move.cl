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

/* Room for rounding, since kernels compute with what is in the box in another order. */
RT_INLINE rt_block rt_widened(rt_block box)
{
    const float4 room = 1e-6f * max(fabs(box.lo), fabs(box.hi));
    box.lo -= room;
    box.hi += room;
    return box;
}

/* The box in the world of an instance of what is in `box`: placed_box() of build_scene.cpp, which explains it. */
RT_INLINE rt_block rt_placed_box(rt_block box, const global rt_placement *placed)
{
    const double rounding = 8.0 * 0x1p-24, gamma = rounding / (1.0 - rounding);
    const float from[2][3] = {{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}};
    double lo[3], hi[3], farthest[3], error[3];
    for (uint k = 0u; k < 3u; ++k) {
        lo[k] = hi[k] = placed->world_from_object[4u * k + 3u];
        for (uint j = 0u; j < 3u; ++j) {
            const double m = placed->world_from_object[4u * k + j], a = m * from[0][j], b = m * from[1][j];
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
    float least[3], most[3];
    for (uint k = 0u; k < 3u; ++k) {
        double room = 0.0;
        for (uint j = 0u; j < 3u; ++j) room += fabs((double)placed->world_from_object[4u * k + j]) * error[j];
        least[k] = convert_float_rtn(lo[k] - room);
        most[k] = convert_float_rtp(hi[k] + room);
    }
    box.lo = (float4)(least[0], least[1], least[2], 0.0f);
    box.hi = (float4)(most[0], most[1], most[2], 0.0f);
    return rt_widened(box);
}

/* The box of a leaf: of an instance and of a shape, what is in it. A leaf is three rows of four numbers; the fourth is no coordinate. */
RT_INLINE rt_block rt_leaf_box(const global float *leaf, uint ref, const global rt_polygon *polygons,
                               const global float *polygon_corners)
{
    const uint kind = RT_REF_KIND(ref);
    const float4 a = vload4(0, leaf), b = vload4(1, leaf);
    rt_block box;
    if (kind == RT_REF_TRIANGLE) {
        const float4 c = vload4(2, leaf);
        box.lo = min(min(a, b), c);
        box.hi = max(max(a, b), c);
    } else if (kind == RT_REF_SPHERE) {
        box.lo = a - b.x;
        box.hi = a + b.x;
        box = rt_widened(box);
    } else if (kind == RT_REF_POLYGON) {
        const rt_polygon polygon = polygons[RT_REF_INDEX(ref)];
        box = rt_no_block();
        for (uint c = 0u; c < polygon.count; ++c) {
            const float4 at = (float4)(vload3(polygon.first + c, polygon_corners), 0.0f);
            box.lo = min(box.lo, at);
            box.hi = max(box.hi, at);
        }
        box = rt_widened(box);
    } else {
        box.lo = min(a, b);
        box.hi = max(a, b);
    }
    /* A transform may have made a coordinate infinite or no number: the box is then as large as it can be. */
    box.lo = min(max(box.lo, (float4)(-FLT_MAX)), (float4)(FLT_MAX));
    box.hi = max(min(box.hi, (float4)(FLT_MAX)), (float4)(-FLT_MAX));
    return box;
}

/* Writes the leaves first .. first + count - 1, and the nine smallest sizes of their blocks. Triangles move if `moves`: corners[ref]
 * are the numbers of their vertices. Instances follow their placement and the box of their group. Positions are in the group's space.
 * all[at], bounds: of the whole group, if it has no more than RT_BLOCK_TILE primitives. */
RT_BUILD_KERNEL move_leaves(global float *leaves, uint first, uint count, uint moves, const global uint *corners,
                            const global float *positions, const global rt_placement *placements,
                            const global uint *group_of_instance, const global rt_block *group_boxes, const global uint *roots,
                            global rt_instance *instances, const global rt_polygon *polygons,
                            const global float *polygon_corners, global rt_block *made, global rt_block *all, uint at,
                            global float *bounds)
{
    local rt_block shared[RT_BLOCK_TILE];
    const uint begin = RT_GROUP_NUMBER * RT_BLOCK_TILE;
    for (uint l = RT_ITEM; l < RT_BLOCK_TILE; l += RT_GROUP) {
        rt_block box = rt_no_block();
        if (begin + l < count) {
            global float *const leaf = leaves + 12ul * (first + begin + l);
            const uint ref = as_uint(leaf[3]), index = RT_REF_INDEX(ref), kind = RT_REF_KIND(ref);
            if (kind == RT_REF_TRIANGLE && moves) {
                const uint3 corner = vload3(index, corners);
                vstore3(vload3(corner.x, positions), 0, leaf);
                vstore3(vload3(corner.y, positions), 0, leaf + 4);
                vstore3(vload3(corner.z, positions), 0, leaf + 8);
            } else if (kind == RT_REF_INSTANCE) {
                const uint group = group_of_instance[index];
                const rt_block placed = rt_placed_box(group_boxes[group], placements + index);
                instances[index].root = roots[group];
                for (uint k = 0u; k < 12u; ++k)
                    instances[index].object_from_world[k] = placements[index].object_from_world[k];
                instances[index].hidden = placements[index].hidden;
                vstore3(placed.lo.xyz, 0, leaf);
                vstore3(placed.hi.xyz, 0, leaf + 4);
            }
            box = rt_leaf_box(leaf, ref, polygons, polygon_corners);
            made[begin + l] = box;
        }
        shared[l] = box;
    }
    RT_LOCAL_BARRIER();
    rt_make_blocks(shared, begin, count, made, all + at, bounds);
}

/* Boxes of the leaves first .. first + count - 1, for builders: from boxes[0] on. */
RT_BUILD_KERNEL leaf_boxes(const global float *leaves, uint first, uint count, uint each, const global rt_polygon *polygons,
                           const global float *polygon_corners, global rt_build_box *boxes)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        const global float *const leaf = leaves + 12ul * (first + i);
        const uint ref = as_uint(leaf[3]);
        rt_block box = rt_leaf_box(leaf, ref, polygons, polygon_corners);
        box.lo.w = as_float(ref);
        box.hi.w = as_float(0u);
        vstore4(box.lo, 0, (global float *)(boxes + i));
        vstore4(box.hi, 1, (global float *)(boxes + i));
    }
}

/* Writes leaves in another order: place first + i of `to` receives what is at order[i] of `from`. */
RT_BUILD_KERNEL order_leaves(const global float *from, global float *to, const global uint *order, uint first, uint count, uint each)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP)
        for (uint row = 0u; row < 3u; ++row)
            vstore4(vload4(3u * order[i] + row, from), 3u * (first + i) + row, to);
}

/* The sum of costs[0] to costs[count - 1], by RT_BLOCK_TILE partial sums, which makes it the same on every device. */
RT_INLINE float rt_sum(local float *shared, const global float *costs, uint count)
{
    for (uint l = RT_ITEM; l < RT_BLOCK_TILE; l += RT_GROUP) {
        float sum = 0.0f;
        for (uint i = l; i < count; i += RT_BLOCK_TILE) sum += costs[i];
        shared[l] = sum;
    }
    RT_LOCAL_BARRIER();
    for (uint step = RT_BLOCK_TILE / 2u; step > 0u; step /= 2u) {
        for (uint l = RT_ITEM; l < step; l += RT_GROUP) shared[l] += shared[l + step];
        RT_LOCAL_BARRIER();
    }
    return shared[0];
}

/* parts[g]: the sum of the costs that work-group g has. */
RT_BUILD_KERNEL add_costs(const global float *costs, uint count, uint each, global float *parts)
{
    local float shared[RT_BLOCK_TILE];
    const uint begin = RT_GROUP_NUMBER * each;
    const float sum = rt_sum(shared, costs + begin, min(each, count - begin));
    if (RT_ITEM == 0u) parts[RT_GROUP_NUMBER] = sum;
}

/* cost[group]: the expected cost of a ray that hits the box of the group, from the sum of `parts`; 0: no ray hits a point or a line. */
RT_BUILD_KERNEL keep_cost(const global float *parts, uint count, uint group, const global rt_block *group_boxes,
                          global float *cost)
{
    local float shared[RT_BLOCK_TILE];
    const float sum = rt_sum(shared, parts, count), area = rt_block_area(group_boxes[group]);
    if (RT_ITEM == 0u) cost[group] = area > 0.0f ? sum / area : 0.0f;
}
