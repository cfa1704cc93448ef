// sky_table.hpp -- pictures that emit: that of the sky as kernels read it, tables by which directions towards it and emitters
// are drawn (cl/shading/sky.h), and the mean light of textures.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rt_types.h"
#include "scene/scene.hpp"
#include "scene/sky.hpp"

namespace clarity {

struct SkyTable {
    // Running sums of shares of RT_PICKS: height + 1 of the rows, then width + 1 of the cells of each row.
    std::vector<rt_u32> picks;
    double flux = 0;               // integral of the picture's mean color over all directions
    std::vector<uint16_t> halves;  // the texels divided by `scale`, each rounded to a half
    float scale = 1;               // a power of two: 1 where halves hold all texels with all digits
};

// A cell of a row is as likely as the light that its part of the sky sends, bilinear between texels.
SkyTable make_sky_table(const Sky& sky);

// How bright a triangle is that emits light as a texture says.

// The mean of the texture's colours, linear, around the part of it that a triangle of the scene shows: over the texels of the
// rectangle that holds that part, or of a smaller picture where these are many. 0 only if no texel there has a colour.
double mean_of_map(const Scene& scene, rt_u32 map, rt_u32 triangle);

// A table by which a random number picks one of many things in proportion to their weights.

// The most things that a table can pick from: each with a weight has one of the RT_PICKS numbers at least.
constexpr size_t kMostPicked = RT_PICKS / 2;

// Deals `total` numbers out in proportion to weights. Each thing with a weight gets one at least; there must be no more of
// these than numbers. If all weights are 0, none gets any.
std::vector<rt_u32> deal(const std::vector<double>& weights, rt_u32 total);

// Fills in threshold, alias and pick of the first weights.size() emitters, and appends cells until there are 2^bits, which it
// returns. See rt_emitter.
unsigned fill_pick_table(const std::vector<double>& weights, std::vector<rt_emitter>& emitters);

}  // namespace clarity
