// ray_blocks.hpp -- rays of ray queries and their answers as kernels keep them: blocks of `lanes` rays, field by field within a
// block. The layout is that of cl/queries/ray_blocks.h.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rt_types.h"

namespace clarity {

class RayBlocks {
 public:
    RayBlocks(const std::vector<rt_ray>& rays, unsigned lanes);
    size_t ray_count() const { return ray_count_; }
    size_t block_count() const { return (ray_count_ + lanes_ - 1) / lanes_; }
    unsigned lanes() const { return lanes_; }
    // Different for all that were packed by themselves: who is asked about the same rays again knows them by it.
    uint64_t packing() const { return packing_; }
    const std::vector<float>& floats() const { return floats_; }

 private:
    size_t ray_count_;
    unsigned lanes_;
    uint64_t packing_;
    std::vector<float> floats_;
};

// In the order of the rays. answers: of all blocks, `fields` a ray: RT_ANSWER_*; what they lack is 0, numbers -1.
// counted: whether there are counters in them.
std::vector<rt_hit> unpack_hits(const std::vector<float>& answers, size_t ray_count, unsigned lanes, rt_u32 fields,
                                bool counted);

}  // namespace clarity
