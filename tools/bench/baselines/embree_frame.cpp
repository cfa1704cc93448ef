// embree_frame.cpp -- threads take tiles of the picture from a shared counter. Each generation of a tile is traced in packets
// of 16, all full but the last one: surviving rays and shadow rays are compacted into arrays, field by field. The arithmetic is
// loops over 16 lanes, which the compiler vectorizes once for each instruction set. Rays and picture are the same as those of
// cl/.
#include "tools/bench/baselines/embree_baseline.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/parallel_for.hpp"
#include "scene/light_kinds.hpp"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__clang__)
#define EACH_ISA __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define EACH_ISA
#endif
#define INLINED inline __attribute__((always_inline))

namespace clarity::bench {
namespace {

constexpr unsigned kWide = 16;
constexpr unsigned kTile = 32;  // pixels, width and height: the data of a tile fits a core's second-level cache
constexpr unsigned kMost = kTile * kTile + kWide;  // rays of a generation, and padding to store a whole packet at the end
constexpr float kOffset = 1.5e-5f;  // of secondary rays above the surface, relative to the largest coordinate or t
constexpr float kFar = 3e38f;       // farther than any hit

struct Lanes {
    alignas(64) float at[kWide];
    float& operator[](unsigned i) { return at[i]; }
    float operator[](unsigned i) const { return at[i]; }
};
INLINED Lanes lanes_of(const float* from) {
    Lanes lanes;
    std::memcpy(lanes.at, from, sizeof lanes.at);
    return lanes;
}
#define EACH_LANE for (unsigned i = 0; i < kWide; ++i)

// Rays to be traced: origin, direction. Shadow rays also have the distance of the light and the light which arrives if nothing
// is in the way.
struct RayQueue {
    alignas(64) float field[8][kMost];
    alignas(64) unsigned pixel[kMost];
    unsigned count = 0;
};

struct Tile {
    RayQueue rays[2], shadow;
    // Per pixel: sum of the weights of rays which were lit (times the cosine), hit something, left the scene.
    float lit[kTile * kTile], met[kTile * kTile], left[kTile * kTile];
    BaselineRayCounts counts;
};

struct Job {
    RTCScene scene;
    const BaselineMesh* mesh;
    const WhittedScene* whitted;
    bool coherent;
    float* film;
};

// Appends lanes of `value` to a field of the queue; `from` lists the lanes.
INLINED void put(RayQueue& queue, unsigned field, const Lanes& value, const unsigned* from) {
    float* const to = &queue.field[field][queue.count];
    EACH_LANE to[i] = value.at[from[i]];
}

// Lists the lanes with a `keep` other than 0, in order; the remaining entries of `from` are valid but arbitrary lanes. Returns
// how many were listed.
INLINED unsigned list_lanes(const unsigned* keep, unsigned* from) {
    unsigned count = 0;
    EACH_LANE from[i] = 0;
    EACH_LANE {
        from[count] = i;
        count += keep[i] != 0;
    }
    if (count < kWide) from[count] = 0;
    return count;
}

INLINED float dot(float ax, float ay, float az, float bx, float by, float bz) {
    return ax * bx + ay * by + az * bz;
}

template <class Rays>
INLINED void load(Rays& to, const RayQueue& queue, unsigned base) {
    const size_t bytes = kWide * sizeof(float);
    std::memcpy(to.org_x, queue.field[0] + base, bytes);
    std::memcpy(to.org_y, queue.field[1] + base, bytes);
    std::memcpy(to.org_z, queue.field[2] + base, bytes);
    std::memcpy(to.dir_x, queue.field[3] + base, bytes);
    std::memcpy(to.dir_y, queue.field[4] + base, bytes);
    std::memcpy(to.dir_z, queue.field[5] + base, bytes);
    std::memset(to.tnear, 0, bytes);
    std::memset(to.time, 0, bytes);
    std::memset(to.mask, 0xff, bytes);
    std::memset(to.flags, 0, bytes);
}

// Makes the camera rays of a tile in blocks of 4x4 pixels, as rt_camera_rays() does.
INLINED void start(Tile& tile, const rt_frame& frame, unsigned left, unsigned top) {
    RayQueue& queue = tile.rays[0];
    queue.count = 0;
    for (unsigned block = 0; block < kTile * kTile / kWide; ++block) {
        const unsigned block_x = block % (kTile / 4) * 4, block_y = block / (kTile / 4) * 4;
        if (left + block_x >= frame.width || top + block_y >= frame.height) continue;
        Lanes dx, dy, dz;
        alignas(64) unsigned inside[kWide], pixel[kWide], from[kWide];
        EACH_LANE {
            const unsigned in_x = block_x + (i & 3u), in_y = block_y + (i >> 2);
            pixel[i] = in_y * kTile + in_x;
            inside[i] = (left + in_x < frame.width) & (top + in_y < frame.height);
            const float sx = (float(int(left + in_x)) + 0.5f) * 2.0f * frame.pixel_x - 1.0f;
            const float sy = 1.0f - (float(int(top + in_y)) + 0.5f) * 2.0f * frame.pixel_y;
            const float x = frame.forward[0] + sy * frame.up[0] + sx * frame.right[0];
            const float y = frame.forward[1] + sy * frame.up[1] + sx * frame.right[1];
            const float z = frame.forward[2] + sy * frame.up[2] + sx * frame.right[2];
            const float scale = 1.0f / std::sqrt(dot(x, y, z, x, y, z));
            dx[i] = x * scale;
            dy[i] = y * scale;
            dz[i] = z * scale;
        }
        const unsigned count = list_lanes(inside, from);
        for (unsigned k = 0; k < 3; ++k) EACH_LANE queue.field[k][queue.count + i] = frame.eye[k];
        put(queue, 3, dx, from);
        put(queue, 4, dy, from);
        put(queue, 5, dz, from);
        EACH_LANE queue.pixel[queue.count + i] = pixel[from[i]];
        queue.count += count;
    }
}

// Sets interpolated vertex normals where the mesh has them; other lanes keep their geometric normals.
INLINED void shading_normals(const BaselineMesh& mesh, const RTCHit16& hit, const unsigned* met, Lanes& nx, Lanes& ny,
                             Lanes& nz) {
    EACH_LANE {
        if (!met[i]) continue;
        const rt_u32* const corner = &mesh.triangles[3 * size_t(hit.primID[i])];
        const float v = hit.u[i], w = hit.v[i], u = 1.0f - v - w;
        const float *a = &mesh.normals[3 * size_t(corner[0])], *b = &mesh.normals[3 * size_t(corner[1])],
                    *c = &mesh.normals[3 * size_t(corner[2])];
        const float x = u * a[0] + v * b[0] + w * c[0], y = u * a[1] + v * b[1] + w * c[1], z = u * a[2] + v * b[2] + w * c[2];
        if (dot(x, y, z, x, y, z) <= 1e-12f) continue;
        nx[i] = x;
        ny[i] = y;
        nz[i] = z;
    }
}

// Traces the packet of `queue` at `base`, and appends shadow rays and mirror rays. See rt_point_of(), rt_direct_light() and
// rt_mirror_direction(). go_on: whether mirror rays are needed for a next generation.
INLINED void trace_packet(const Job& job, Tile& tile, const RayQueue& queue, unsigned base, float weight, bool go_on,
                          EmbreeQuery& query, RayQueue& next) {
    const WhittedScene& whitted = *job.whitted;
    alignas(64) int valid[kWide];
    alignas(64) RTCRayHit16 packet;
    load(packet.ray, queue, base);
    EACH_LANE valid[i] = base + i < queue.count ? -1 : 0;
    EACH_LANE packet.ray.tfar[i] = kFar;
    std::memset(packet.hit.geomID, 0xff, sizeof packet.hit.geomID);
    query.closest(valid, job.scene, &packet);

    alignas(64) unsigned met[kWide], lit[kWide], from[kWide];
    unsigned any_met = 0;
    EACH_LANE any_met |= met[i] = valid[i] != 0 && packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    const unsigned in_queue = std::min(kWide, queue.count - base);
    const unsigned* const pixel = &queue.pixel[base];
    for (unsigned i = 0; i < in_queue; ++i) (met[i] ? tile.met : tile.left)[pixel[i]] += weight;
    if (!any_met) return;

    // Copies of Embree's output. The compiler can vectorize the loop only if it knows that nothing else changes the arrays, as
    // with local ones.
    const Lanes hit_t = lanes_of(packet.ray.tfar), g_x = lanes_of(packet.hit.Ng_x), g_y = lanes_of(packet.hit.Ng_y),
                g_z = lanes_of(packet.hit.Ng_z);
    Lanes nx = g_x, ny = g_y, nz = g_z;
    if (!job.mesh->normals.empty()) shading_normals(*job.mesh, packet.hit, met, nx, ny, nz);
    const Lanes o_x = lanes_of(packet.ray.org_x), o_y = lanes_of(packet.ray.org_y), o_z = lanes_of(packet.ray.org_z),
                d_x = lanes_of(packet.ray.dir_x), d_y = lanes_of(packet.ray.dir_y), d_z = lanes_of(packet.ray.dir_z);
    Lanes ox, oy, oz, lx, ly, lz, far, brought, mx, my, mz;
    const bool point = light_kind_of(whitted.light).has_place;
    const float light_x = whitted.light.position[0], light_y = whitted.light.position[1], light_z = whitted.light.position[2];
    EACH_LANE {
        const float t = met[i] ? hit_t[i] : 0.0f, dx = d_x[i], dy = d_y[i], dz = d_z[i];
        const float x = o_x[i] + t * dx, y = o_y[i] + t * dy, z = o_z[i] + t * dz;
        float gx = g_x[i], gy = g_y[i], gz = g_z[i];
        float scale = 1.0f / std::sqrt(std::max(dot(gx, gy, gz, gx, gy, gz), 1e-36f));
        scale = dot(gx, gy, gz, dx, dy, dz) > 0.0f ? -scale : scale;
        gx *= scale, gy *= scale, gz *= scale;
        float px = nx[i], py = ny[i], pz = nz[i];
        scale = 1.0f / std::sqrt(std::max(dot(px, py, pz, px, py, pz), 1e-36f));
        scale = dot(px, py, pz, gx, gy, gz) < 0.0f ? -scale : scale;
        px *= scale, py *= scale, pz *= scale;
        const bool away = dot(px, py, pz, dx, dy, dz) >= 0.0f;
        px = away ? gx : px, py = away ? gy : py, pz = away ? gz : pz;
        const float offset = kOffset * std::max(std::max(std::max(std::fabs(x), std::fabs(y)), std::fabs(z)), t);
        ox[i] = x + offset * gx;
        oy[i] = y + offset * gy;
        oz[i] = z + offset * gz;
        float tx = light_x - (point ? ox[i] : 0.0f), ty = light_y - (point ? oy[i] : 0.0f),
              tz = light_z - (point ? oz[i] : 0.0f);
        const float length2 = std::max(dot(tx, ty, tz, tx, ty, tz), 1e-36f), shrink = point ? 1.0f / std::sqrt(length2) : 1.0f;
        tx *= shrink, ty *= shrink, tz *= shrink;
        lx[i] = tx, ly[i] = ty, lz[i] = tz;
        far[i] = point ? 1.0f / shrink : kFar;
        const float cosine = dot(px, py, pz, tx, ty, tz);
        lit[i] = met[i] & unsigned(cosine > 0.0f) & unsigned(dot(gx, gy, gz, tx, ty, tz) > 0.0f);
        brought[i] = weight * cosine;
        const float twice = 2.0f * std::min(-dot(px, py, pz, dx, dy, dz), 1.0f);
        float rx = dx + twice * px, ry = dy + twice * py, rz = dz + twice * pz;
        const float below = -2.0f * std::min(dot(rx, ry, rz, gx, gy, gz), 0.0f);
        rx += below * gx, ry += below * gy, rz += below * gz;
        scale = 1.0f / std::sqrt(std::max(dot(rx, ry, rz, rx, ry, rz), 1e-36f));
        mx[i] = rx * scale;
        my[i] = ry * scale;
        mz[i] = rz * scale;
    }
    if (const unsigned count = list_lanes(lit, from)) {
        RayQueue& shadow = tile.shadow;
        const Lanes* const fields[] = {&ox, &oy, &oz, &lx, &ly, &lz, &far, &brought};
        for (unsigned k = 0; k < 8; ++k) put(shadow, k, *fields[k], from);
        EACH_LANE shadow.pixel[shadow.count + i] = pixel[from[i]];
        shadow.count += count;
    }
    if (!go_on) return;
    const unsigned count = list_lanes(met, from);
    const Lanes* const fields[] = {&ox, &oy, &oz, &mx, &my, &mz};
    for (unsigned k = 0; k < 6; ++k) put(next, k, *fields[k], from);
    EACH_LANE next.pixel[next.count + i] = pixel[from[i]];
    next.count += count;
}

INLINED void trace_shadows(const Job& job, Tile& tile, EmbreeQuery& query) {
    const RayQueue& queue = tile.shadow;
    for (unsigned base = 0; base < queue.count; base += kWide) {
        alignas(64) int valid[kWide];
        alignas(64) RTCRay16 packet;
        load(packet, queue, base);
        std::memcpy(packet.tfar, queue.field[6] + base, sizeof packet.tfar);
        EACH_LANE valid[i] = base + i < queue.count ? -1 : 0;
        query.any(valid, job.scene, &packet);
        const unsigned count = std::min(kWide, queue.count - base);
        for (unsigned i = 0; i < count; ++i)
            tile.lit[queue.pixel[base + i]] += packet.tfar[i] < 0.0f ? 0.0f : queue.field[7][base + i];
    }
}

}  // namespace

// Outside of the unnamed namespace because of target_clones: the program's loader picks one of the clones.
EACH_ISA void embree_tile(const Job& job, Tile& tile, unsigned left, unsigned top);

EACH_ISA void embree_tile(const Job& job, Tile& tile, unsigned left, unsigned top) {
    const WhittedScene& whitted = *job.whitted;
    const rt_frame& frame = whitted.frame;
    std::memset(tile.lit, 0, sizeof tile.lit);
    std::memset(tile.met, 0, sizeof tile.met);
    std::memset(tile.left, 0, sizeof tile.left);
    start(tile, frame, left, top);
    tile.counts.primary += tile.rays[0].count;
    float weight = 1;
    for (unsigned generation = 0; generation < whitted.generations; ++generation) {
        RayQueue& queue = tile.rays[generation & 1u];
        RayQueue& next = tile.rays[1u - (generation & 1u)];
        if (queue.count == 0) break;
        EmbreeQuery query(generation == 0 || job.coherent);
        next.count = tile.shadow.count = 0;
        const bool go_on = generation + 1 < whitted.generations && weight * whitted.reflect > whitted.min_weight;
        for (unsigned base = 0; base < queue.count; base += kWide)
            trace_packet(job, tile, queue, base, weight, go_on, query, next);
        trace_shadows(job, tile, query);
        tile.counts.shadow += tile.shadow.count;
        tile.counts.secondary += next.count;
        weight *= whitted.reflect;
    }
    // The model of cl/shading/shading.h without emission and highlights, which these materials do not have.
    const float share = (1.0f - whitted.reflect) * whitted.color;
    const unsigned wide = std::min(kTile, frame.width - left), high = std::min(kTile, frame.height - top);
    for (unsigned y = 0; y < high; ++y) {
        float* to = job.film + 4 * (size_t(top + y) * frame.width + left);
        for (unsigned x = 0; x < wide; ++x, to += 4) {
            const unsigned i = y * kTile + x;
            for (unsigned k = 0; k < 3; ++k)
                to[k] = share * (tile.lit[i] * whitted.light.color[k] + tile.met[i] * frame.ambient[k]) +
                        tile.left[i] * frame.background[k];
            to[3] = 1;
        }
    }
}

double embree_frame(RTCScene scene, const BaselineMesh& mesh, const WhittedScene& whitted, bool coherent, unsigned threads,
                    BaselineArray<float>& film, BaselineRayCounts& counts) {
    const rt_frame& frame = whitted.frame;
    film.resize(4 * size_t(frame.width) * frame.height);
    const Job job = {scene, &mesh, &whitted, coherent, film.data()};
    const unsigned across = (frame.width + kTile - 1) / kTile, tiles = across * ((frame.height + kTile - 1) / kTile);
    std::vector<Tile> scratch(threads);
    std::atomic<unsigned> next{0};
    const auto begin = std::chrono::steady_clock::now();
    parallel_for(threads, [&](uint32_t thread) {
#if defined(__SSE2__)
        const unsigned saved = _mm_getcsr();
        _mm_setcsr(saved | 0x8040);  // flush denormal results (FTZ) and operands (DAZ) to zero
#endif
        for (unsigned i = next++; i < tiles; i = next++)
            embree_tile(job, scratch[thread], i % across * kTile, i / across * kTile);
#if defined(__SSE2__)
        _mm_setcsr(saved);
#endif
    });
    const double ms = ms_since(begin);
    counts = {};
    for (const Tile& tile : scratch) {
        counts.primary += tile.counts.primary;
        counts.shadow += tile.counts.shadow;
        counts.secondary += tile.counts.secondary;
    }
    return ms;
}

}  // namespace clarity::bench
