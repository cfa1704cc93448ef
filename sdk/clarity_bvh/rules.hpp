// rules.hpp -- the rules of a build: which method, which costs, which limits.
#pragma once
#include <cstdint>

namespace clarity::bvh {

// How primitives are split. The values are those of builder_param() (parameters.hpp).
enum class Method {
    sah,     // binned surface area heuristic (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies")
    morton,  // along a space-filling curve: several times faster to build, slower to trace (Lauterbach et al. 2009, "Fast BVH
             // Construction on GPUs")
    spatial  // sah, and triangles are cut too where that pays: slow to build, for large triangles among small (Stich,
             // Friedrich, Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies")
};

// The costs by which trees are judged, and the limits of a build.
struct Rules {
    uint32_t max_leaf;        // most primitives in a leaf, 1..kLeafMax
    uint32_t bins;            // slices per axis in which split planes are sought, 2..kMaxBins
    float traversal_cost;     // of a node to a ray; any unit that intersection_cost shares
    float intersection_cost;  // of a primitive to a ray
    Method method = Method::sah;
    float duplicates = 0;   // references that spatial splits may add, as a fraction of the number of primitives
    uint32_t reinsert = 0;  // passes of reinsertion at most (build/reinsert.hpp); 0: none
    bool halves = false;    // split by count, without the heuristic: the baseline that shows what the heuristic gains
};

constexpr uint32_t kMaxBins = 32;

// No leaf is deeper than this. Where halving the rest by count would only just stay within the limit, ranges are halved.
// Without the limit, scenes with thousands of interpenetrating primitives or geometrically shrinking ones would make long
// chains of nodes.
constexpr uint32_t kMaxDepth = 64;

// The least number of bits in which the numbers 0..n - 1 fit: as many times can n primitives be halved by count.
constexpr uint32_t log2_ceil(uint32_t n) {
    uint32_t bits = 0;
    while ((uint64_t{1} << bits) < n) ++bits;
    return bits;
}

}  // namespace clarity::bvh
