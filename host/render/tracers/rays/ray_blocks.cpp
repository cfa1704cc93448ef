#include "render/tracers/rays/ray_blocks.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <iterator>

#include "base/parallel_for.hpp"

namespace clarity {
namespace {

constexpr size_t kChunk = 16384;  // rays in one task; a multiple of kAtOnce
constexpr size_t kAtOnce = 256;   // rays that are read or written at once, 8 KB; a multiple of all lane counts
static_assert(sizeof(rt_ray) == RT_RAY_FIELDS * sizeof(float) && sizeof(rt_hit) == RT_ANSWER_ALL * sizeof(float),
              "rays and hits are fields of four bytes");

template <class Work>
void for_chunks(size_t count, const Work& work) {
    parallel_for(static_cast<uint32_t>((count + kChunk - 1) / kChunk), [&](uint32_t chunk) {
        for (size_t i = chunk * kChunk, end = std::min(count, (chunk + 1) * kChunk); i < end; i += kAtOnce)
            work(i, std::min(end, i + kAtOnce));
    });
}

rt_hit answer_at(const float* block, unsigned lanes, rt_u32 fields) {
    rt_hit hit{*block, 0, 0, -1, -1, 0, 0, 0};
    if (fields == RT_ANSWER_HIT) {
        hit.u = block[1], hit.v = block[2];
        std::memcpy(&hit.prim, block + 3, sizeof hit.prim);
    } else if (fields == RT_ANSWER_NEAREST) {
        std::memcpy(&hit.prim, block + lanes, sizeof hit.prim);
    } else if (fields >= RT_ANSWER_ALL) {
        float all[RT_ANSWER_ALL];
        for (size_t k = 0; k < RT_ANSWER_ALL; ++k) all[k] = block[k * lanes];
        std::memcpy(&hit, all, sizeof hit);
        if (fields != kAnswerCounted) hit.steps = hit.leaf_tests = hit.lane_steps = 0;
    }
    return hit;
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

void unpack_hits(const float* answers, size_t ray_count, unsigned lanes, rt_u32 fields, const TakeHits& take) {
    for_chunks(ray_count, [&](size_t first, size_t end) {
        rt_hit hits[kAtOnce];
        for (size_t i = first; i < end; ++i)
            hits[i - first] = answer_at(&answers[i / lanes * lanes * fields] + i % lanes, lanes, fields);
        take(first, end - first, hits);
    });
}

std::vector<RayWork> unpack_work(const float* answers, size_t ray_count, unsigned lanes) {
    std::vector<RayWork> work(ray_count);
    for (size_t i = 0; i < ray_count; ++i) {
        const float* const more = &answers[i / lanes * lanes * kAnswerCounted] + RT_ANSWER_ALL * lanes + i % lanes;
        float numbers[kAnswerCounted - RT_ANSWER_ALL];
        for (size_t k = 0; k < std::size(numbers); ++k) numbers[k] = more[k * lanes];
        static_assert(sizeof numbers == sizeof(RayWork), "the counters of an answer");
        std::memcpy(&work[i], numbers, sizeof numbers);
    }
    return work;
}

}  // namespace clarity
