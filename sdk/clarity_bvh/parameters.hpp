// parameters.hpp -- the parameters that structures built with this library have in common (rt_param), so that they have the
// same names, limits and words everywhere. A plugin lists those that it has in its own table, with its own defaults.
#pragma once
#include "clarity_bvh/rules.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// Rules::max_leaf. most: at most kLeafMax.
constexpr rt_param max_leaf_param(int most, int usual) {
    return rt::int_param("max_leaf", "Max leaf size",
                         "primitives in a leaf, at most; fewer where the heuristic finds that cheaper", 1, most, usual);
}
// Rules::bins.
constexpr rt_param bins_param() {
    return rt::int_param("bins", "Bins",
                         "slices per axis in which split planes are sought; more: slower to build, slightly better", 2,
                         kMaxBins, 32);
}
// Rules::traversal_cost.
constexpr rt_param traversal_param(double usual) {
    return rt::float_param("traversal_cost", "Traversal cost", "what a node costs a ray, in the unit of the intersection cost",
                           0.01, 100, usual);
}
// Rules::intersection_cost.
constexpr rt_param intersection_param(double usual) {
    return rt::float_param("intersection_cost", "Intersection cost",
                           "what a primitive costs a ray, in the unit of the traversal cost", 0.01, 100, usual);
}
// Rules::method. The default is Method::sah.
inline constexpr const char* kBuilders[] = {"sah", "morton", "spatial", nullptr};
constexpr rt_param builder_param() {
    return rt::enum_param(
        "builder", "Builder",
        "sah: binned surface area heuristic; morton: along a space-filling curve, several times faster to build and "
        "slower to trace; spatial: heuristic that cuts triangles too, slow to build, for large ones among small",
        kBuilders, 0);
}
// Rules::duplicates.
constexpr rt_param duplicates_param() {
    return rt::float_param("duplicates", "Duplicates",
                           "what builder=spatial may add to the primitives, as a share of their number", 0, 4, 0.3);
}
// Rules::reinsert.
constexpr rt_param reinsert_param() {
    return rt::int_param("reinsert", "Reinsertion",
                         "passes that move subtrees to better places, at most; 0: none; several times slower to build, faster "
                         "to trace where rays part",
                         0, 100, 0);
}

// A table that begins with the parameters of wide trees has them in this order, so that wide_rules() finds them. A plugin may
// append its own from kOwnParams on.
enum WideParam { kMaxLeaf, kBins, kTraversalCost, kIntersectionCost, kBuilder, kDuplicates, kReinsert, kOwnParams };
// The rules of rt_build_input::params, in the order of WideParam.
inline Rules wide_rules(const double* params) {
    return {static_cast<uint32_t>(params[kMaxLeaf]),    static_cast<uint32_t>(params[kBins]),
            static_cast<float>(params[kTraversalCost]), static_cast<float>(params[kIntersectionCost]),
            static_cast<Method>(params[kBuilder]),      static_cast<float>(params[kDuplicates]),
            static_cast<uint32_t>(params[kReinsert])};
}

}  // namespace clarity::bvh
