// parameters.hpp -- the table of bvh2's parameters, and the rules that they make.
#pragma once
#include "clarity_bvh/parameters.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"

namespace bvh2 {

enum Param { kMaxLeaf, kBins, kTraversalCost, kIntersectionCost, kSplit, kBuilder, kDuplicates, kReinsert };
inline constexpr const char* kSplits[] = {"sah", "median", nullptr};
inline constexpr rt_param kParams[] = {
    clarity::bvh::max_leaf_param(BVH2_LEAF_MAX, 4),
    clarity::bvh::bins_param(),
    clarity::bvh::traversal_param(1),
    clarity::bvh::intersection_param(1),
    rt::enum_param("split", "Split", "where nodes are parted: by the surface area heuristic, or into even halves by count",
                   kSplits, 0),
    clarity::bvh::builder_param(),
    clarity::bvh::duplicates_param(),
    clarity::bvh::reinsert_param(),
};

inline clarity::bvh::Rules rules_of(const double* params) {
    return {static_cast<uint32_t>(params[kMaxLeaf]),
            static_cast<uint32_t>(params[kBins]),
            static_cast<float>(params[kTraversalCost]),
            static_cast<float>(params[kIntersectionCost]),
            static_cast<clarity::bvh::Method>(params[kBuilder]),
            static_cast<float>(params[kDuplicates]),
            static_cast<uint32_t>(params[kReinsert]),
            params[kSplit] == 1};
}

}  // namespace bvh2
