// sky_table.hpp -- a picture of the sky as kernels read it, and tables by which directions towards it are drawn
// (cl/shading/sky.h).
#pragma once
#include <cstdint>
#include <vector>

#include "scene/sky.hpp"

namespace clarity {

struct SkyTable {
    // Running sums of shares of RT_PICKS: height + 1 of the rows, then width + 1 of the cells of each row.
    std::vector<rt_u32> picks;
    double flux = 0;               // integral of the picture's mean color over all directions
    std::vector<uint16_t> halves;  // the texels divided by `scale`, each rounded to a half
    float scale = 1;               // a power of two: 1 unless a texel is larger than the largest half
};

// A cell of a row is as likely as the light that its part of the sky sends, bilinear between texels.
SkyTable make_sky_table(const Sky& sky);

}  // namespace clarity
