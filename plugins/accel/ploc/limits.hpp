// limits.hpp -- the numbers that the build on the host and the plan for the device share.
#pragma once
#include <algorithm>
#include <cstdint>

#include "clarity_bvh/build/morton_order.hpp"

namespace ploc {

// Places of the curve that one work-item, or thread, takes.
constexpr uint64_t kPart = 4096;
constexpr uint64_t parts_of(uint64_t count) {
    return (count + kPart - 1) / kPart;
}
constexpr uint64_t kPendingWords = 161;  // PLOC_OPEN + 1

// A tree that is higher becomes the radix tree, which is not. Trees of scenes were 15 to 75 nodes high.
constexpr uint32_t height_limit(uint64_t count) {
    return std::max(128u, clarity::bvh::depth_bound(count));
}

}  // namespace ploc
