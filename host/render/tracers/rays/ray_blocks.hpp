// ray_blocks.hpp -- the layout in which kernels read rays of ray queries and write answers: blocks of `lanes` rays, field by
// field within a block, as in cl/tracers/rays/ray_blocks.h.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rt_types.h"

namespace clarity {

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

// Returns the hits in the order of the rays.
// answers: of all blocks, `fields` numbers a ray (RT_ANSWER_*). Members of rt_hit that they do not contain become 0, and -1 for
// numbers. counted: whether the answers contain counters.
std::vector<rt_hit> unpack_hits(const std::vector<float>& answers, size_t ray_count, unsigned lanes, rt_u32 fields,
                                bool counted);

}  // namespace clarity
