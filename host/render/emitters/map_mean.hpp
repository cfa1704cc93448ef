// map_mean.hpp -- how bright a triangle is that emits light as a texture says.
#pragma once
#include "scene/scene.hpp"

namespace clarity {

// The mean of the texture's colours, linear, around the part of it that a triangle of the scene shows: over the texels of the
// rectangle that holds that part, or of a smaller picture where these are many. 0 only if no texel there has a colour.
double mean_of_map(const Scene& scene, rt_u32 map, rt_u32 triangle);

}  // namespace clarity
