/* camera.h -- the pixels of a work-item, and the camera rays through them.
 *
 * A work-item has a packet of packet_w x packet_h pixels, as in the thesis. It loops over blocks of RT_LANES pixels and traces
 * RT_STREAM blocks together (packet_stream.h). A work-group has several packets, so that neighbours in the picture run close in
 * time. On a CPU (RT_CPU) a work-group is one work-item that traces these packets one after the other. PoCL would keep the
 * private arrays of all work-items of a group side by side, which would not fit into the cache. There a group has as many
 * packets as fit into 16 pixels in each direction, at least one and at most four, so that there are enough groups for many
 * cores. The packet's size is a member of the frame, so changing it compiles nothing. Only RT_MAX_PIXELS, its upper limit, is
 * compiled in. */
#ifndef RT_CAMERA_H
#define RT_CAMERA_H

/* Code that only the inspector's program has, which records rays: tracers/inspect/recorder.h. */
#ifdef RT_INSPECT
#define RT_RECORD(code) code;
#else
#define RT_RECORD(code)
#endif

/* Code that only programs have which write the denoiser's guides: tracers/path/guides.h. */
#ifdef RT_GUIDES
#define RT_GUIDE(code) code;
#else
#define RT_GUIDE(code)
#endif

#if RT_MAX_PIXELS == 1 /* on GPUs, constants tell the compiler that a packet is one pixel */
#define RT_PACKET_W(frame) 1u
#define RT_PACKET_H(frame) 1u
#define RT_BLOCKS(frame) 1u
#else
#define RT_PACKET_W(frame) ((frame)->packet_w)
#define RT_PACKET_H(frame) ((frame)->packet_h)
#define RT_BLOCKS(frame) ((frame)->blocks_x * (frame)->blocks_y)
#endif

/* The packets of a group in each direction, at most RT_GROUP_SIDE. The host has them as Layout::group_w and group_h. */
#if RT_CPU
#define RT_IN_GROUP(packet_side) clamp(16u / (packet_side), 1u, (uint)RT_GROUP_SIDE)
#define RT_GROUP_W(frame) RT_IN_GROUP(RT_PACKET_W(frame))
#define RT_GROUP_H(frame) RT_IN_GROUP(RT_PACKET_H(frame))
#define RT_LOCAL_SIZE 1
#define RT_FOR_PACKETS(frame, packet) for (uint packet = 0; packet < RT_GROUP_PACKETS(frame); ++packet)
#else
#define RT_GROUP_W(frame) RT_GROUP_SIDE
#define RT_GROUP_H(frame) RT_GROUP_SIDE
#define RT_LOCAL_SIZE (RT_GROUP_SIDE * RT_GROUP_SIDE)
#define RT_FOR_PACKETS(frame, packet) for (uint packet = (uint)get_local_id(0), once = 1; once; once = 0)
#endif
#define RT_GROUP_PACKETS(frame) (RT_GROUP_W(frame) * RT_GROUP_H(frame))

/* A launch computes the groups from first_group on, group_count of them. On a GPU each has a work-group of its own. On a CPU there are as many
 * work-groups as threads, and each takes the next group_share groups until none is left. PoCL itself deals out 1 / threads of what is left at a
 * time, so that all others would wait for the thread that has the dearest part of a picture, or a core that something else uses, too.
 * `taken` counts shares on from launch to launch; taken_before is what it counted before this one. */
#if RT_CPU
#define RT_GROUPS_PARAMS const uint first_group, const uint group_count, const uint group_share, const uint taken_before, volatile global uint *taken,
#define RT_FOR_GROUPS(group) \
    for (uint group, group##_end; rt_take_groups(group_count, group_share, taken_before, taken, &group, &group##_end);) \
        for (group += first_group, group##_end += first_group; group < group##_end; ++group)
RT_INLINE bool rt_take_groups(uint count, uint share, uint taken_before, volatile global uint *taken, uint *begin, uint *end)
{
    *begin = (atomic_inc(taken) - taken_before) * share;
    *end = min(*begin + share, count);
    return *begin < count;
}
#else
#define RT_GROUPS_PARAMS const uint first_group,
#define RT_FOR_GROUPS(group) for (uint group = first_group + (uint)get_group_id(0), group##_once = 1u; group##_once != 0u; group##_once = 0u)
#endif

/* The first pixel of a packet. group: the index of the work-group, row by row over the picture, or over the device's rows of
 * groups where several devices share the picture. packet: the packet's index in the group. */
RT_INLINE uint2 rt_packet_origin(const constant rt_frame *frame, uint group, uint packet)
{
    const uint w = RT_PACKET_W(frame), h = RT_PACKET_H(frame);
    const uint group_w = RT_GROUP_W(frame), groups_x = (frame->width + w * group_w - 1) / (w * group_w);
    uint row = group / groups_x;
    const uint x = (group % groups_x) * group_w + packet % group_w;
    if (frame->row_count != 0u) row = ((const constant uint *)(frame + frame->layers))[row];
    const uint y = row * RT_GROUP_H(frame) + packet / group_w;
    return (uint2)(x * w, y * h);
}

/* The sample of a launch that a work-group computes. *group: in, the group's index in the launch; out, its index in the sample.
 * The samples of one group follow each other, so that each finds in the caches what the one before has fetched. */
RT_INLINE uint rt_layer_of(const constant rt_frame *frame, uint *group)
{
#if RT_MAX_PIXELS == 1 && RT_LANES == 1
    const uint layer = *group % frame->layers;
    *group /= frame->layers;
    return layer;
#else
    return 0u;
#endif
}

/* Computes each lane's pixel, counted from the packet's first. Returns the lanes that have a pixel inside packet and picture. */
RT_INLINE vmask rt_block_pixels(const constant rt_frame *frame, uint2 origin, uint block, vint *in_x, vint *in_y)
{
#if RT_MAX_PIXELS == 1 && RT_LANES == 1
    *in_x = *in_y = 0;
    return RT_MASK(origin.x < frame->width) & RT_MASK(origin.y < frame->height);
#else
    const uint block_x = (block % frame->blocks_x) << frame->block_w_log2;
    const uint block_y = (block / frame->blocks_x) * (RT_LANES >> frame->block_w_log2);
    const vint lane = rt_lane_index();
    const vint x = rt_vint((int)block_x) + (lane & rt_vint((int)frame->block_w - 1));
    const vint y = rt_vint((int)block_y) + (lane >> rt_vint((int)frame->block_w_log2));
    *in_x = x;
    *in_y = y;
    return RT_MASK(x < rt_vint((int)RT_PACKET_W(frame))) & RT_MASK(y < rt_vint((int)RT_PACKET_H(frame))) &
           RT_MASK(x + rt_vint((int)origin.x) < rt_vint((int)frame->width)) &
           RT_MASK(y + rt_vint((int)origin.y) < rt_vint((int)frame->height));
#endif
}

/* Computes the camera rays through points of the picture, in pixels. */
RT_INLINE void rt_camera_rays_through(const constant rt_frame *frame, vfloat px, vfloat py, rt_rays *r)
{
    const vfloat sx = fma(px, rt_vfloat(2.0f * frame->pixel_x), rt_vfloat(-1.0f));
    const vfloat sy = fma(py, rt_vfloat(-2.0f * frame->pixel_y), rt_vfloat(1.0f));
    const vfloat dx = fma(sx, rt_vfloat(frame->right[0]), fma(sy, rt_vfloat(frame->up[0]), rt_vfloat(frame->forward[0])));
    const vfloat dy = fma(sx, rt_vfloat(frame->right[1]), fma(sy, rt_vfloat(frame->up[1]), rt_vfloat(frame->forward[1])));
    const vfloat dz = fma(sx, rt_vfloat(frame->right[2]), fma(sy, rt_vfloat(frame->up[2]), rt_vfloat(frame->forward[2])));
    const vfloat scale = rt_vfloat(1.0f) / sqrt(fma(dx, dx, fma(dy, dy, dz * dz)));
    r->ox = rt_vfloat(frame->eye[0]);
    r->oy = rt_vfloat(frame->eye[1]);
    r->oz = rt_vfloat(frame->eye[2]);
    r->dx = dx * scale;
    r->dy = dy * scale;
    r->dz = dz * scale;
    r->t_min = rt_vfloat(0.0f);
#ifdef RT_CARRIES_CONES
    r->travelled = rt_vfloat(0.0f);
#endif
}

/* Computes the camera rays through pixels (x, y) of the film. A sample's rays go through the same point of every pixel, which
 * the frame holds. So a picture does not depend on which device renders which pixel when, and packets stay coherent. */
RT_INLINE void rt_camera_rays(const constant rt_frame *frame, vint x, vint y, rt_rays *r)
{
    rt_camera_rays_through(frame, rt_to_float(x + rt_vint((int)frame->first_x)) + rt_vfloat(frame->within_x),
                           rt_to_float(y + rt_vint((int)frame->first_y)) + rt_vfloat(frame->within_y), r);
}

#if RT_STREAM > 1 && !RT_HAS_PLANES
/* Returns true if no camera ray of a packet enters the bounds of all primitives but planes. The test bounds the directions before
 * normalisation: they are affine in the pixels, so they lie between those of the packet's corners. */
RT_INLINE bool rt_packet_misses(const constant rt_frame *frame, uint2 origin)
{
    /* The packet's corners, one in each lane, with the x and y of rt_camera_rays(). */
    const float4 px = convert_float(origin.x + frame->first_x) + (float4)(0.0f, 1.0f, 0.0f, 1.0f) * convert_float(RT_PACKET_W(frame) - 1u) + frame->within_x;
    const float4 py = convert_float(origin.y + frame->first_y) + (float4)(0.0f, 0.0f, 1.0f, 1.0f) * convert_float(RT_PACKET_H(frame) - 1u) + frame->within_y;
    const float4 sx = px * (2.0f * frame->pixel_x) - 1.0f, sy = py * (-2.0f * frame->pixel_y) + 1.0f;
    float enter = 0.0f, leave = MAXFLOAT;
    for (uint k = 0; k < 3u; ++k) {
        const float4 d = sx * frame->right[k] + sy * frame->up[k] + frame->forward[k];
        /* A millionth of the sum of magnitudes covers the rounding, in rt_camera_rays() and here. `forward` has unit length. */
        const float slack = 1e-6f * (1.0f + fabs(frame->right[k]) + fabs(frame->up[k]));
        const float hi = rt_max(rt_max(d.x, d.y), rt_max(d.z, d.w)) + slack, lo = rt_min(rt_min(d.x, d.y), rt_min(d.z, d.w)) - slack;
        const float to_lower = frame->bounds[k] - frame->eye[k], to_upper = frame->bounds[3u + k] - frame->eye[k];
        /* Along this axis, no ray reaches the nearer side earlier than the fastest ray, and none leaves the bounds later than the
         * slowest. */
        if (to_lower > 0.0f) {
            if (hi <= 0.0f) return true;
            enter = rt_max(enter, to_lower / hi);
            if (lo > 0.0f) leave = rt_min(leave, to_upper / lo);
        } else if (to_upper < 0.0f) {
            if (lo >= 0.0f) return true;
            enter = rt_max(enter, to_upper / lo);
            if (hi < 0.0f) leave = rt_min(leave, to_lower / hi);
        } else {
            if (lo > 0.0f) leave = rt_min(leave, to_upper / lo);
            if (hi < 0.0f) leave = rt_min(leave, to_lower / hi);
        }
    }
    return enter > leave * 1.00001f;
}
#endif

/* Adds the sums of a packet's pixels to the film, row by row, or stores them there if frame->adds is 0. */
RT_INLINE void rt_put_pixels(const constant rt_frame *frame, uint2 origin, const float4 *sums, global float4 *film)
{
    const uint packet_w = RT_PACKET_W(frame);
    if (origin.x >= frame->width || origin.y >= frame->height) return;
    const uint columns = min(packet_w, frame->width - origin.x), rows = min(RT_PACKET_H(frame), frame->height - origin.y);
    for (uint y = 0; y < rows; ++y) {
        global float4 *const to = film + (size_t)(origin.y + y) * frame->width + origin.x;
        const float4 *const from = sums + y * packet_w;
        if (frame->adds == 0u)
            for (uint x = 0; x < columns; ++x) to[x] = from[x];
        else
            for (uint x = 0; x < columns; ++x) to[x] += from[x];
    }
}

/* Prepares hits for a query: active lanes look up to any distance, inactive lanes have t = -1. */
RT_INLINE void rt_clear_hits(rt_hits *h, vmask active)
{
    h->t = rt_select(active, RT_INFINITY, rt_vfloat(-1.0f));
    h->u = h->v = h->nx = h->ny = h->nz = rt_vfloat(0.0f);
    h->leaf = h->instance = rt_vint(-1);
    h->prim = rt_vint(-1); /* less than all numbers of primitives, so that a primitive exactly at t_max is no hit */
    rt_clear_counters(h);
#ifdef RT_DEBUG
    h->overflow = 0;
#endif
}

RT_INLINE void rt_fill_with_background(const constant rt_frame *frame, float4 *sums)
{
    const float4 background = (float4)(frame->background[0], frame->background[1], frame->background[2], 1.0f);
    for (uint i = 0; i < RT_PACKET_W(frame) * RT_PACKET_H(frame); ++i) sums[i] = background;
}

/* Returns true if a packet sees only background. Then it has filled the packet's pixels and the distances of its camera rays,
 * block by block. */
RT_INLINE bool rt_only_background(const constant rt_frame *frame, uint2 origin, float4 *sums, global float *distance)
{
#if RT_STREAM > 1 && !RT_HAS_PLANES
    if (!rt_packet_misses(frame, origin)) return false;
    rt_fill_with_background(frame, sums);
    for (uint i = 0; frame->sample == 0u && i < RT_BLOCKS(frame); ++i) rt_store(RT_INFINITY, distance + i * RT_LANES);
    return true;
#else
    return false;
#endif
}

#endif
