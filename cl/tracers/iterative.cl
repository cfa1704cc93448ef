/* iterative.cl -- Whitted's ray tracing without recursion, as the thesis has it.
 *
 * Whitted 1980, An Improved Illumination Model for Shaded Display. A packet of pixels owns two arrays, the rays of the current
 * generation and of the next. Each step traces all current rays, adds what they see to their pixels and appends reflected and
 * refracted rays to the next array; then the arrays change places, until none is left or `depth` generations are done.
 * The arrays hold RT_RAY_SLOTS rays a pixel. A ray that finds no room is dropped and counted.
 * The arrays are private memory for RT_MAX_PIXELS, 2 x 10 floats x (RT_MAX_PIXELS RT_RAY_SLOTS + RT_LANES), of which only what is
 * used is touched. */

#define RT_CAPACITY (RT_MAX_PIXELS * RT_RAY_SLOTS)
#define RT_RAY_OFFSET 1.5e-5f /* 256 ulp, of the largest coordinate or the distance */
#define RT_FIELDS 9 /* origin, direction, weight */

typedef struct rt_queue {
    float field[RT_FIELDS][RT_CAPACITY + RT_LANES];
    int pixel[RT_CAPACITY + RT_LANES]; /* within the packet */
} rt_queue;

/* Lanes in bits move to the front. */
#if !defined(RT_PORTABLE) && defined(__x86_64__) && RT_LANES == 16 && defined(__AVX512F__)
#define RT_COMPRESS_FLOAT(v, bits) __builtin_ia32_compresssf512_mask(v, (float16)(0.0f), (ushort)(bits))
#define RT_COMPRESS_INT(v, bits) __builtin_ia32_compresssi512_mask(v, (int16)(0), (ushort)(bits))
#elif RT_LANES == 1
#define RT_COMPRESS_FLOAT(v, bits) (v)
#define RT_COMPRESS_INT(v, bits) (v)
#else
RT_INLINE vfloat rt_compress_float(vfloat v, uint bits)
{
    float in[RT_LANES], out[RT_LANES];
    rt_store(v, in);
    rt_store(rt_vfloat(0.0f), out);
    for (uint l = 0, n = 0; l < RT_LANES; ++l)
        if (bits >> l & 1u) out[n++] = in[l];
    return rt_load(out);
}
#define RT_COMPRESS_FLOAT(v, bits) rt_compress_float(v, bits)
#define RT_COMPRESS_INT(v, bits) rt_as_vint(rt_compress_float(rt_as_vfloat(v), bits))
#endif

/* Appends the lanes in bits; returns the new count, and adds those that found no room to *dropped. */
RT_INLINE uint rt_append(rt_queue *queue, uint capacity, uint count, uint bits, vfloat ox, vfloat oy, vfloat oz, vfloat dx, vfloat dy, vfloat dz,
                         vfloat wr, vfloat wg, vfloat wb, vint pixel, uint *dropped)
{
    const uint wanted = popcount(bits), room = capacity - count, taken = min(wanted, room);
    *dropped += wanted - taken;
    if (taken == 0u) return count;
    rt_store(RT_COMPRESS_FLOAT(ox, bits), queue->field[0] + count);
    rt_store(RT_COMPRESS_FLOAT(oy, bits), queue->field[1] + count);
    rt_store(RT_COMPRESS_FLOAT(oz, bits), queue->field[2] + count);
    rt_store(RT_COMPRESS_FLOAT(dx, bits), queue->field[3] + count);
    rt_store(RT_COMPRESS_FLOAT(dy, bits), queue->field[4] + count);
    rt_store(RT_COMPRESS_FLOAT(dz, bits), queue->field[5] + count);
    rt_store(RT_COMPRESS_FLOAT(wr, bits), queue->field[6] + count);
    rt_store(RT_COMPRESS_FLOAT(wg, bits), queue->field[7] + count);
    rt_store(RT_COMPRESS_FLOAT(wb, bits), queue->field[8] + count);
    rt_store(RT_COMPRESS_INT(pixel, bits), queue->pixel + count);
    return count + taken;
}

/* counters: one uint4 a packet: shadow rays, secondary rays, dropped rays, stack overflows. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_iterative(const constant rt_frame *frame, const uint first_group, global float4 *film, global uint4 *counters, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint group = first_group + (uint)get_group_id(0);
    rt_queue queues[2];
    float color_r[RT_MAX_PIXELS], color_g[RT_MAX_PIXELS], color_b[RT_MAX_PIXELS];
    const uint packet_w = RT_PACKET_W(frame), pixels = packet_w * RT_PACKET_H(frame), capacity = pixels * RT_RAY_SLOTS;
    RT_FOR_PACKETS(packet)
    {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        uint shadow_count = 0, secondary_count = 0, dropped = 0, overflow = 0;
        for (uint i = 0; i < pixels; ++i) color_r[i] = color_g[i] = color_b[i] = 0.0f;

        const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
        uint count = RT_BLOCKS(frame) * RT_LANES; /* the first generation is made, not stored */
        for (uint generation = 0; generation < frame->depth && count != 0u; ++generation) {
            const rt_queue *current = queues + (generation & 1u);
            rt_queue *next = queues + (1u - (generation & 1u));
            uint next_count = 0;
            for (uint base = 0; base < count; base += RT_LANES) {
                rt_rays ray;
                vfloat wr = one, wg = one, wb = one;
                vint pixel;
                vmask active;
                if (generation == 0u) {
                    vint in_x, in_y;
                    active = rt_block_pixels(frame, origin, base / RT_LANES, &in_x, &in_y);
                    pixel = in_y * rt_vint((int)packet_w) + in_x;
                    rt_camera_rays(frame, in_x + rt_vint((int)origin.x), in_y + rt_vint((int)origin.y), &ray);
                } else {
                    active = RT_MASK(rt_lane_index() + rt_vint((int)base) < rt_vint((int)count));
                    ray.ox = rt_load(current->field[0] + base);
                    ray.oy = rt_load(current->field[1] + base);
                    ray.oz = rt_load(current->field[2] + base);
                    ray.dx = rt_load(current->field[3] + base);
                    ray.dy = rt_load(current->field[4] + base);
                    ray.dz = rt_load(current->field[5] + base);
                    ray.t_min = zero;
                    wr = rt_load(current->field[6] + base);
                    wg = rt_load(current->field[7] + base);
                    wb = rt_load(current->field[8] + base);
                    pixel = rt_load(current->pixel + base);
                }
                const uint bits = rt_bits(active);
                if (bits == 0u) continue;

                rt_hits hit;
                rt_prepare(&ray, bits);
                rt_clear_hits(&hit, active);
                rt_trace_closest(&ctx, frame, &ray, &hit);
#ifdef RT_DEBUG
                overflow += hit.overflow;
#endif
                const rt_surface s = rt_resolve(&ctx, &ray, &hit, bits);
                const vmask hits = s.hit & active;
                const uint hit_bits = rt_bits(hits);

                vfloat r = wr * frame->background[0], g = wg * frame->background[1], b = wb * frame->background[2];
                if (hit_bits != 0u) {
                    const vfloat t = rt_select(hits, hit.t, zero);
                    const vfloat px = fma(t, ray.dx, ray.ox), py = fma(t, ray.dy, ray.oy), pz = fma(t, ray.dz, ray.oz);
                    const rt_shade m = rt_load_materials(&ctx, &s, hit_bits, px, pz);

                    /* Normals towards where the ray comes from. */
                    const vmask leaving = RT_MASK(rt_dot3(s.nx, s.ny, s.nz, ray.dx, ray.dy, ray.dz) > zero);
                    const vfloat side = rt_select(leaving, -one, one);
                    const vfloat gx = s.nx * side, gy = s.ny * side, gz = s.nz * side;
                    vfloat nx = s.sx * side, ny = s.sy * side, nz = s.sz * side;
                    /* An interpolated normal may point away from the viewer at silhouettes: there the geometric one serves. */
                    const vmask turned = RT_MASK(rt_dot3(nx, ny, nz, ray.dx, ray.dy, ray.dz) >= zero);
                    nx = rt_select(turned, gx, nx);
                    ny = rt_select(turned, gy, ny);
                    nz = rt_select(turned, gz, nz);
                    const vfloat cos_in = rt_min(-rt_dot3(nx, ny, nz, ray.dx, ray.dy, ray.dz), one);

                    /* Rounding of the hit point grows with its coordinates and the ray's length; so does the offset. */
                    const vfloat reach = rt_max(rt_max(fabs(px), fabs(py)), rt_max(fabs(pz), t));
                    const vfloat offset = reach * RT_RAY_OFFSET;
                    const vfloat above_x = fma(gx, offset, px), above_y = fma(gy, offset, py), above_z = fma(gz, offset, pz);

                    const vfloat diffuse = rt_max(one - m.reflect - m.refract, zero);
                    vfloat light_r = rt_vfloat(frame->ambient[0]), light_g = rt_vfloat(frame->ambient[1]), light_b = rt_vfloat(frame->ambient[2]);
                    vfloat shine_r = zero, shine_g = zero, shine_b = zero;
                    for (uint i = 0; i < frame->light_count; ++i) {
                        const global rt_light *light = ctx.lights + i;
                        rt_rays shadow;
                        vfloat distance = RT_INFINITY;
                        shadow.dx = rt_vfloat(light->position[0]);
                        shadow.dy = rt_vfloat(light->position[1]);
                        shadow.dz = rt_vfloat(light->position[2]);
                        if (light->kind == RT_LIGHT_POINT) {
                            shadow.dx -= above_x;
                            shadow.dy -= above_y;
                            shadow.dz -= above_z;
                            const vfloat scale = rt_inverse_length(shadow.dx, shadow.dy, shadow.dz);
                            distance = one / scale;
                            shadow.dx *= scale;
                            shadow.dy *= scale;
                            shadow.dz *= scale;
                        }
                        const vfloat cos_light = rt_dot3(nx, ny, nz, shadow.dx, shadow.dy, shadow.dz);
                        vmask lit = hits & RT_MASK(cos_light > zero) & RT_MASK(rt_dot3(gx, gy, gz, shadow.dx, shadow.dy, shadow.dz) > zero);
                        const uint lit_bits = rt_bits(lit);
                        if (lit_bits == 0u) continue;
                        if (frame->shadows != 0u) {
                            rt_hits blocked;
                            shadow.ox = above_x;
                            shadow.oy = above_y;
                            shadow.oz = above_z;
                            shadow.t_min = zero;
                            rt_prepare(&shadow, lit_bits);
                            rt_clear_hits(&blocked, lit);
                            blocked.t = rt_select(lit, distance, rt_vfloat(-1.0f));
                            rt_trace_any(&ctx, frame, &shadow, &blocked);
#ifdef RT_DEBUG
                            overflow += blocked.overflow;
#endif
                            lit &= RT_MASK(blocked.t >= zero);
                            shadow_count += popcount(lit_bits);
                        }
                        /* Lambert, and Blinn's half vector. */
                        const vfloat hx = shadow.dx - ray.dx, hy = shadow.dy - ray.dy, hz = shadow.dz - ray.dz;
                        const vfloat cos_half = rt_max(rt_dot3(nx, ny, nz, hx, hy, hz) * rt_inverse_length(hx, hy, hz), zero);
                        const vfloat lambert = rt_select(lit, cos_light, zero);
                        const vfloat highlight = rt_select(lit, rt_power(rt_min(cos_half, one), m.shininess), zero);
                        light_r = fma(lambert, rt_vfloat(light->color[0]), light_r);
                        light_g = fma(lambert, rt_vfloat(light->color[1]), light_g);
                        light_b = fma(lambert, rt_vfloat(light->color[2]), light_b);
                        shine_r = fma(highlight, rt_vfloat(light->color[0]), shine_r);
                        shine_g = fma(highlight, rt_vfloat(light->color[1]), shine_g);
                        shine_b = fma(highlight, rt_vfloat(light->color[2]), shine_b);
                    }
                    r = rt_select(hits, wr * (m.er + diffuse * m.r * light_r + m.spr * shine_r), r);
                    g = rt_select(hits, wg * (m.eg + diffuse * m.g * light_g + m.spg * shine_g), g);
                    b = rt_select(hits, wb * (m.eb + diffuse * m.b * light_b + m.spb * shine_b), b);

                    if (generation + 1u < frame->depth) {
                        /* Fresnel for unpolarised light; sin2 > 1 is total internal reflection. */
                        const vmask glass = hits & RT_MASK(m.refract > zero);
                        const vfloat eta = rt_select(leaving, m.ior, one / m.ior);
                        const vfloat sin2 = eta * eta * rt_max(one - cos_in * cos_in, zero);
                        const vmask total = RT_MASK(sin2 >= one);
                        const vfloat cos_out = sqrt(rt_max(one - sin2, zero));
                        const vfloat perpendicular = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
                        const vfloat parallel = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
                        vfloat fresnel = 0.5f * (perpendicular * perpendicular + parallel * parallel);
                        fresnel = rt_select(total, one, fresnel);
                        const vfloat mirrored = m.reflect + rt_select(glass, m.refract * fresnel, zero);
                        const vfloat passed = rt_select(glass, m.refract * (one - fresnel), zero);

                        const vfloat heaviest = rt_max(wr, rt_max(wg, wb));
                        const uint mirror_bits = rt_bits(hits & RT_MASK(mirrored * heaviest > rt_vfloat(frame->min_weight)));
                        const uint pass_bits = rt_bits(glass & RT_MASK(passed * heaviest > rt_vfloat(frame->min_weight)));
                        if (mirror_bits != 0u) {
                            const vfloat twice = cos_in * 2.0f;
                            vfloat dx = fma(twice, nx, ray.dx), dy = fma(twice, ny, ray.dy), dz = fma(twice, nz, ray.dz);
                            const vfloat below = rt_min(rt_dot3(dx, dy, dz, gx, gy, gz), zero); /* never into the surface */
                            dx = fma(below * -2.0f, gx, dx);
                            dy = fma(below * -2.0f, gy, dy);
                            dz = fma(below * -2.0f, gz, dz);
                            const vfloat scale = rt_inverse_length(dx, dy, dz);
                            next_count = rt_append(next, capacity, next_count, mirror_bits, above_x, above_y, above_z, dx * scale, dy * scale,
                                                   dz * scale, wr * mirrored, wg * mirrored, wb * mirrored, pixel, &dropped);
                        }
                        if (pass_bits != 0u) {
                            const vfloat bend = eta * cos_in - cos_out;
                            const vfloat dx = fma(eta, ray.dx, bend * nx), dy = fma(eta, ray.dy, bend * ny), dz = fma(eta, ray.dz, bend * nz);
                            const vfloat scale = rt_inverse_length(dx, dy, dz);
                            next_count = rt_append(next, capacity, next_count, pass_bits, fma(gx, -offset, px), fma(gy, -offset, py),
                                                   fma(gz, -offset, pz), dx * scale, dy * scale, dz * scale, wr * passed * m.r,
                                                   wg * passed * m.g, wb * passed * m.b, pixel, &dropped);
                        }
                    }
                }

                /* Two lanes may belong to one pixel, so this is done one by one. */
                float add_r[RT_LANES], add_g[RT_LANES], add_b[RT_LANES];
                int at[RT_LANES];
                rt_store(r, add_r);
                rt_store(g, add_g);
                rt_store(b, add_b);
                rt_store(pixel, at);
                for (uint l = 0; l < RT_LANES; ++l) {
                    if ((bits >> l & 1u) == 0u) continue;
                    color_r[at[l]] += add_r[l];
                    color_g[at[l]] += add_g[l];
                    color_b[at[l]] += add_b[l];
                }
            }
            count = next_count;
            if (generation + 1u < frame->depth) secondary_count += next_count;
        }

        for (uint i = 0; i < pixels; ++i) {
            const uint x = origin.x + i % packet_w, y = origin.y + i / packet_w;
            if (x >= frame->width || y >= frame->height) continue;
            float4 value = (float4)(color_r[i], color_g[i], color_b[i], 1.0f);
            const uint at = y * frame->width + x;
            if (frame->sample != 0u) value += film[at];
            film[at] = value;
        }
        counters[group * (RT_GROUP_W * RT_GROUP_H) + packet] = (uint4)(shadow_count, secondary_count, dropped, overflow);
    }
}
