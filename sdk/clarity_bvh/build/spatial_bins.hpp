// spatial_bins.hpp -- bins the parts of primitives between equally spaced planes through a box.
#pragma once
#include "clarity_bvh/kernels/range.hpp"
#include "rt_plugin.h"

namespace clarity::bvh {

constexpr uint32_t kSpatialBins = 16;

Bounds bounds_of(const Record& record);

// Equally spaced planes that cut a box into kSpatialBins slices on each axis.
class Planes {
 public:
    explicit Planes(const Bounds& box);
    uint32_t slice(int axis, float x) const;
    float plane(int axis, uint32_t slice) const;  // coordinate where the slice begins

 private:
    float base_[3], step_[3], scale_[3];
};

// The first and last slice of a primitive on one axis. A primitive that cannot be cut lies in one slice only.
struct SliceRange {
    uint32_t first, last;
};
SliceRange extent(const Planes& planes, int axis, const Record& record);

// Bounds of the part of a triangle between two planes, limited to `part`, the box of the part that is already known. Rounding
// is outwards, so the bounds always contain it.
Bounds clip(const rt_packed_prim& triangle, const Bounds& part, int axis, float from, float to);

struct SpatialBins {
    Bounds box[kSpatialBins][3];
    // Number of primitives for which this is the first (enter) or the last (leave) slice.
    uint32_t enter[kSpatialBins][3] = {}, leave[kSpatialBins][3] = {};
    void add(const Record* first, const Record* end, const Planes& planes, const rt_geometry& geometry);
    void add(const SpatialBins& other);
};

// A spatial split. Primitives that reach into slices below `bin` go left. Primitives that reach into `bin` or above go right.
// Some go to both.
struct SpatialSplit {
    float cost = INFINITY;  // as in Split
    int axis = 0;
    uint32_t bin = 0, left_count = 0, right_count = 0;
    Bounds left, right;
};
SpatialSplit find_spatial_split(const SpatialBins& bins, const AreaScale& area);

}  // namespace clarity::bvh
