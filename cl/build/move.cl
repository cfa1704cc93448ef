/* move.cl -- the primitives of a scene that moves: leaves and boxes of one group follow the vertices and transforms.
 *
 * A triangle moves about 200 B through memory: 12 of vertex numbers, its vertices, its leaf both ways, its box, its share of larger
 * boxes. Neighbouring work-items of a GPU read and write neighbouring rows of 16 B, through local memory. */
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

/* A leaf: rt_packed_prim as three rows of four numbers, of which the fourth is no coordinate. */
typedef struct rt_leaf {
    float4 a, b, c;
} rt_leaf;
#define RT_LEAF_REF(leaf) as_uint((leaf).a.w)
RT_INLINE rt_leaf rt_load_leaf(const global float *from)
{
    rt_leaf leaf;
    leaf.a = vload4(0, from);
    leaf.b = vload4(1, from);
    leaf.c = vload4(2, from);
    return leaf;
}

/* The box of a leaf: of an instance and of a shape, what is in it. */
RT_INLINE rt_block rt_leaf_box(rt_leaf leaf, const global rt_polygon *polygons, const global float *polygon_corners)
{
    const uint ref = RT_LEAF_REF(leaf), kind = RT_REF_KIND(ref);
    const float4 a = leaf.a, b = leaf.b;
    rt_block box;
    if (kind == RT_REF_TRIANGLE) {
        box.lo = min(min(a, b), leaf.c);
        box.hi = max(max(a, b), leaf.c);
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

/* What moves: triangles if `moves`, to the vertices that corners[ref] names, in the group's space; instances, which follow their
 * placement and the box of their group. */
typedef struct rt_pose {
    const global uint *corners;
    const global float *positions;
    const global rt_placement *placements;
    const global uint *group_of_instance;
    const global rt_block *group_boxes;
    const global uint *roots;
    global rt_instance *instances;
} rt_pose;

RT_INLINE rt_leaf rt_move_leaf(rt_leaf leaf, const rt_pose *pose, uint moves)
{
    const uint ref = RT_LEAF_REF(leaf), index = RT_REF_INDEX(ref), kind = RT_REF_KIND(ref);
    if (kind == RT_REF_TRIANGLE && moves) {
        const uint3 corner = vload3(index, pose->corners);
        leaf.a.xyz = vload3(corner.x, pose->positions);
        leaf.b.xyz = vload3(corner.y, pose->positions);
        leaf.c.xyz = vload3(corner.z, pose->positions);
    } else if (kind == RT_REF_INSTANCE) {
        const uint group = pose->group_of_instance[index];
        const global rt_placement *const placement = pose->placements + index;
        const rt_block placed = rt_placed_box(pose->group_boxes[group], placement);
        global rt_instance *const instance = pose->instances + index;
        instance->root = pose->roots[group];
        for (uint k = 0u; k < 12u; ++k) instance->object_from_world[k] = placement->object_from_world[k];
        instance->hidden = placement->hidden;
        leaf.a.xyz = placed.lo.xyz;
        leaf.b.xyz = placed.hi.xyz;
    }
    return leaf;
}

/* Writes the leaves first .. first + count - 1, and the nine smallest sizes of their blocks. all[at], bounds: of the whole group, if it
 * has no more than RT_BLOCK_TILE primitives. */
RT_BUILD_KERNEL move_leaves(global float *leaves, uint first, uint count, uint moves, const global uint *corners,
                            const global float *positions, const global rt_placement *placements,
                            const global uint *group_of_instance, const global rt_block *group_boxes, const global uint *roots,
                            global rt_instance *instances, const global rt_polygon *polygons,
                            const global float *polygon_corners, global rt_block *made, global rt_block *all, uint at,
                            global float *bounds)
{
    local rt_block shared[RT_BLOCK_TILE];
    const rt_pose pose = {corners, positions, placements, group_of_instance, group_boxes, roots, instances};
    const uint begin = RT_GROUP_NUMBER * RT_BLOCK_TILE;
#if RT_GROUP == 1
    for (uint l = 0u; l < RT_BLOCK_TILE; ++l) {
        shared[l] = rt_no_block();
        if (begin + l >= count) continue;
        global float *const to = leaves + 12ul * (first + begin + l);
        const rt_leaf leaf = rt_move_leaf(rt_load_leaf(to), &pose, moves);
        vstore4(leaf.a, 0, to);
        vstore4(leaf.b, 1, to);
        vstore4(leaf.c, 2, to);
        made[begin + l] = shared[l] = rt_leaf_box(leaf, polygons, polygon_corners);
    }
#else /* RT_GROUP is RT_BLOCK_TILE */
    local float4 rows[3u * RT_BLOCK_TILE];
    global float *const tile = leaves + 12ul * (first + begin);
    const uint in_tile = min(RT_BLOCK_TILE, count - begin);
    for (uint r = RT_ITEM; r < 3u * in_tile; r += RT_GROUP) rows[r] = vload4(r, tile);
    RT_LOCAL_BARRIER();
    rt_block box = rt_no_block();
    if (RT_ITEM < in_tile) {
        local float4 *const row = rows + 3u * RT_ITEM;
        rt_leaf leaf = {row[0], row[1], row[2]};
        leaf = rt_move_leaf(leaf, &pose, moves);
        row[0] = leaf.a;
        row[1] = leaf.b;
        row[2] = leaf.c;
        box = rt_leaf_box(leaf, polygons, polygon_corners);
    }
    shared[RT_ITEM] = box;
    RT_LOCAL_BARRIER();
    for (uint r = RT_ITEM; r < 3u * in_tile; r += RT_GROUP) vstore4(rows[r], r, tile);
    for (uint r = RT_ITEM; r < 2u * in_tile; r += RT_GROUP)
        vstore4(((const local float4 *)shared)[r], 2ul * begin + r, (global float *)made);
#endif
    rt_make_blocks(shared, begin, count, made, all + at, bounds);
}

/* Boxes of the leaves first .. first + count - 1, for builders: from boxes[0] on. */
RT_BUILD_KERNEL leaf_boxes(const global float *leaves, uint first, uint count, uint each, const global rt_polygon *polygons,
                           const global float *polygon_corners, global rt_build_box *boxes)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        const rt_leaf leaf = rt_load_leaf(leaves + 12ul * (first + i));
        rt_block box = rt_leaf_box(leaf, polygons, polygon_corners);
        box.lo.w = leaf.a.w; /* ref */
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
