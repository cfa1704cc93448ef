// points.hpp -- what turns points into spheres: a radius that fits their spacing, and a material for each colour.
#pragma once
#include <vector>

#include "rt_plugin.h"

namespace pointcloud {

// The median distance of points to their nearest neighbour; points at one place do not count. 0: no two places differ.
// positions: three numbers a point.
double spacing(const std::vector<float>& positions);

// Colours with the points that have them.
struct Palette {
    std::vector<float> colors;  // linear r, g, b of each
    std::vector<rt_u32> of_point;
    size_t different = 0;  // colours of 8 bits a channel that the points have
};
// At most 2^15 colours: where points have more, bits of channels are dropped, and a group of colours has its mean.
// colors: linear r, g, b, and alpha a point.
Palette palette_of(const std::vector<float>& colors);

}  // namespace pointcloud
