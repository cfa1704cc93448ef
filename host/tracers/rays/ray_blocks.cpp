#include "tracers/rays/ray_blocks.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "base/parallel_for.hpp"

namespace clarity {
namespace {

constexpr size_t kChunk = 16384;  // rays in one task; a multiple of kAtOnce
constexpr size_t kAtOnce = 256;   // rays that are read or written at once, 8 KB; a multiple of all lane counts
static_assert(sizeof(rt_ray) == RT_RAY_FIELDS * sizeof(float), "rays are fields of four bytes");

template <class Work>
void for_chunks(size_t count, const Work& work) {
    parallel_for(static_cast<uint32_t>((count + kChunk - 1) / kChunk), [&](uint32_t chunk) {
        for (size_t i = chunk * kChunk, end = std::min(count, (chunk + 1) * kChunk); i < end; i += kAtOnce)
            work(i, std::min(end, i + kAtOnce));
    });
}

template <class Number>
void read_number(const float* from, Number& to) {
    static_assert(sizeof to == sizeof *from, "numbers of an answer have four bytes");
    std::memcpy(&to, from, sizeof to);
}

RayWork work_at(const float* answers, size_t ray, size_t stride) {
    RayWork work;
    const float* from = answers + RT_ANSWER_PLACED * stride + ray;
#define READ_COUNTER(name, how, of_hit) read_number(from, work.name), from += stride;
    RT_HIT_COUNTERS(READ_COUNTER)
#undef READ_COUNTER
    return work;
}

}  // namespace

uint64_t new_packing() {
    static std::atomic<uint64_t> packings{0};
    return ++packings;
}

void pack_rays(size_t ray_count, unsigned lanes, const ReadRays& read, float* blocks) {
    for_chunks(ray_count, [&](size_t first, size_t end) {
        rt_ray rays[kAtOnce];
        read(first, end - first, rays);
        // Lanes behind the last ray repeat it, so that packets still find their rays similar, but with an empty interval that
        // hits nothing.
        const size_t filled = end < ray_count ? end : (end + lanes - 1) / lanes * lanes;
        for (size_t i = first; i < filled; ++i) {
            rt_ray& ray = rays[std::min(i, end - 1) - first];
            if (i >= end) ray.t_max = -1;
            float fields[RT_RAY_FIELDS];
            std::memcpy(fields, &ray, sizeof fields);
            float* block = &blocks[i / lanes * lanes * RT_RAY_FIELDS] + i % lanes;
            for (size_t k = 0; k < RT_RAY_FIELDS; ++k) block[k * lanes] = fields[k];
        }
    });
}

RayBlocks::RayBlocks(const std::vector<rt_ray>& rays, unsigned lanes)
    : ray_count_(rays.size()), lanes_(lanes), packing_(new_packing()), floats_(block_floats(rays.size(), lanes)) {
    pack_rays(
        rays.size(), lanes,
        [&](size_t first, size_t count, rt_ray* to) { std::memcpy(to, &rays[first], count * sizeof(rt_ray)); }, floats_.data());
}

void unpack_hits(const float* answers, size_t ray_count, size_t stride, rt_u32 fields, const TakeHits& take) {
    for_chunks(ray_count, [&](size_t first, size_t end) {
        rt_hit hits[kAtOnce];
        for (size_t i = first; i < end; ++i) {
            rt_hit& hit = hits[i - first];
            hit = {answers[i], 0, 0, -1, -1, 0, 0, 0};
            if (fields >= RT_ANSWER_NEAREST) read_number(answers + stride + i, hit.prim);
            if (fields >= RT_ANSWER_HIT) hit.u = answers[2 * stride + 2 * i], hit.v = answers[2 * stride + 2 * i + 1];
            if (fields >= RT_ANSWER_PLACED) read_number(answers + 4 * stride + i, hit.instance);
            if (fields < kAnswerCounted) continue;
            const RayWork work = work_at(answers, i, stride);
            hit.steps = work.steps, hit.leaf_tests = work.leaf_tests, hit.lane_steps = work.lane_steps;
        }
        take(first, end - first, hits);
    });
}

std::vector<RayWork> unpack_work(const float* answers, size_t ray_count, size_t stride) {
    std::vector<RayWork> work(ray_count);
    for (size_t i = 0; i < ray_count; ++i) work[i] = work_at(answers, i, stride);
    return work;
}

}  // namespace clarity
