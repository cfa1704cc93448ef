#include "render/tracers/rays/ray_blocks.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "base/parallel_for.hpp"

namespace clarity {
namespace {

constexpr size_t kChunk = 16384;  // rays in one task; a multiple of all lane counts
static_assert(sizeof(rt_ray) == RT_RAY_FIELDS * sizeof(float) && sizeof(rt_hit) == RT_ANSWER_ALL * sizeof(float),
              "rays and hits are fields of four bytes");

template <class Work>
void for_chunks(size_t count, const Work& work) {
    parallel_for(static_cast<uint32_t>((count + kChunk - 1) / kChunk),
                 [&](uint32_t chunk) { work(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

}  // namespace

RayBlocks::RayBlocks(const std::vector<rt_ray>& rays, unsigned lanes) : ray_count_(rays.size()), lanes_(lanes) {
    static std::atomic<uint64_t> packings{0};
    packing_ = ++packings;
    floats_.resize(block_count() * lanes * RT_RAY_FIELDS);
    // Lanes behind the last ray repeat it, so that packets still find their rays similar, but with an empty interval that hits
    // nothing.
    for_chunks(block_count() * lanes, [&](size_t first, size_t end) {
        for (size_t i = first; i < end; ++i) {
            rt_ray ray = rays[std::min(i, rays.size() - 1)];
            if (i >= rays.size()) ray.t_max = -1;
            float fields[RT_RAY_FIELDS];
            std::memcpy(fields, &ray, sizeof fields);
            float* block = &floats_[i / lanes * lanes * RT_RAY_FIELDS] + i % lanes;
            for (size_t k = 0; k < RT_RAY_FIELDS; ++k) block[k * lanes] = fields[k];
        }
    });
}

std::vector<rt_hit> unpack_hits(const std::vector<float>& answers, size_t ray_count, unsigned lanes, rt_u32 fields,
                                bool counted) {
    std::vector<rt_hit> hits(ray_count);
    for_chunks(ray_count, [&](size_t first, size_t end) {
        for (size_t i = first; i < end; ++i) {
            const float* block = &answers[i / lanes * lanes * fields] + i % lanes;
            rt_hit& hit = hits[i];
            if (fields == RT_ANSWER_HIT) {
                hit = {block[0], block[1], block[2], -1, -1, 0, 0, 0};
                std::memcpy(&hit.prim, block + 3, sizeof hit.prim);
                continue;
            }
            if (fields != RT_ANSWER_ALL) {
                hit = {*block, 0, 0, -1, -1, 0, 0, 0};
                if (fields == RT_ANSWER_NEAREST) std::memcpy(&hit.prim, block + lanes, sizeof hit.prim);
                continue;
            }
            float all[RT_ANSWER_ALL];
            for (size_t k = 0; k < RT_ANSWER_ALL; ++k) all[k] = block[k * lanes];
            std::memcpy(&hit, all, sizeof hit);
            if (!counted) hit.steps = hit.leaf_tests = hit.lane_steps = 0;
        }
    });
    return hits;
}

}  // namespace clarity
