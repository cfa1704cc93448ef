// spatial_bins.hpp -- which parts of primitives lie between equally spaced planes through a box.
#pragma once
#include "range.hpp"
#include "rt_plugin.h"

namespace bvh2 {

constexpr uint32_t kSpatialBins = 16;

// Planes that part a box into kSpatialBins slices on each axis.
class Planes {
 public:
    explicit Planes(const Bounds& box);
    uint32_t slice(int axis, float x) const;
    float plane(int axis, uint32_t slice) const;  // where it begins

 private:
    float base_[3], step_[3], scale_[3];
};

// Its slices on one axis. What cannot be cut lies in one only.
struct Extent {
    uint32_t first, last;
};
Extent extent(const Planes& planes, int axis, const Record& record);

// Bounds of what lies between two planes of a triangle, which `part` is a part of. They hold all of it: rounding is outwards.
Bounds clip(const rt_packed_prim& triangle, const Bounds& part, int axis, float from, float to);

struct SpatialBins {
    Bounds box[kSpatialBins][3];
    uint32_t enter[kSpatialBins][3] = {}, leave[kSpatialBins][3] = {};  // primitives whose first, last slice it is
    void add(const Record* first, const Record* end, const Planes& planes, const rt_geometry& geometry);
    void add(const SpatialBins& other);
};

// What reaches into slices below `bin` goes left, what reaches into the others, right.
struct SpatialSplit {
    float cost = INFINITY;  // as Split's
    int axis = 0;
    uint32_t bin = 0, left_count = 0, right_count = 0;
    Bounds left, right;
};
SpatialSplit find_spatial_split(const SpatialBins& bins, const AreaScale& area);

}  // namespace bvh2
