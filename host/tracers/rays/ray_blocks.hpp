// ray_blocks.hpp -- the layout in which kernels read rays of ray queries, blocks of `lanes` rays, field by field within a
// block, and in which they write answers, array by array, as in cl/tracers/rays/ray_blocks.h.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "rt_types.h"
#include "tracers/rays/ray_query.hpp"

namespace clarity {

// Writes the rays [first, first + count) to `to`. Called for few rays at a time, which stay in a core's cache, from several
// threads.
using ReadRays = std::function<void(size_t first, size_t count, rt_ray* to)>;
// Gets hits of the rays [first, first + count), in the same way.
using TakeHits = std::function<void(size_t first, size_t count, const rt_hit* hits)>;

// A new id of a set of rays: see RayBlocks::packing().
uint64_t new_packing();
// Numbers of the blocks of rays.
inline size_t block_floats(size_t ray_count, unsigned lanes) {
    return (ray_count + lanes - 1) / lanes * lanes * RT_RAY_FIELDS;
}
// Writes block_floats() numbers, on all threads.
void pack_rays(size_t ray_count, unsigned lanes, const ReadRays& read, float* blocks);

// Immutable.
class RayBlocks {
 public:
    // Packs the rays, on all threads.
    RayBlocks(const std::vector<rt_ray>& rays, unsigned lanes);
    size_t ray_count() const { return ray_count_; }
    size_t block_count() const { return (ray_count_ + lanes_ - 1) / lanes_; }
    unsigned lanes() const { return lanes_; }
    // A unique id of each packing. Callers use it to recognise rays that they have seen before.
    uint64_t packing() const { return packing_; }
    const std::vector<float>& floats() const { return floats_; }

 private:
    size_t ray_count_;
    unsigned lanes_;
    uint64_t packing_;
    std::vector<float> floats_;
};

// Numbers of an answer, beside RT_ANSWER_*: with counters.
constexpr rt_u32 kAnswerCounted = RT_ANSWER_PLACED + RT_HIT_COUNTER_COUNT;
// How far the arrays of answers lie apart: they begin at cache lines, and have room for the last block of any number of lanes.
inline size_t answer_stride(size_t ray_count) {
    return (ray_count + 63) / 64 * 64;
}
// Reads answers on all threads. Members of rt_hit that they do not contain become 0, and -1 for numbers.
void unpack_hits(const float* answers, size_t ray_count, size_t stride, rt_u32 fields, const TakeHits& take);
// The counters of answers of kAnswerCounted numbers.
std::vector<RayWork> unpack_work(const float* answers, size_t ray_count, size_t stride);

}  // namespace clarity
