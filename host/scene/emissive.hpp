// emissive.hpp -- which primitives of a scene emit light, and which of them a path tracer can draw light from.
#pragma once
#include <cstddef>
#include <cstdint>

#include "rt_types.h"

namespace clarity {

struct Material;
struct MaterialValues;
struct Scene;

// Whether a surface emits light.
bool emits(const rt_material& material);

// Whether light is drawn from a surface with these values, if it emits. It is not where it is cut out, and where a texture says
// how much varnish dims it: rays that hit such a surface find its light. own: the material of the scene, whose textures count.
bool is_drawn(const MaterialValues& values, const Material& own);

// Placed primitives that emit light.
struct EmissiveCounts {
    uint64_t triangles = 0, spheres = 0, polygons = 0;
    // Found by rays alone that happen to hit them.
    uint64_t planes = 0, shapes = 0, bent_polygons = 0, cut_out = 0;  // cut_out: or below varnish with a texture
    uint64_t by_rays_alone() const { return planes + shapes + bent_polygons + cut_out; }
};
EmissiveCounts count_emissive(const Scene& scene);

// Whether a polygon, 3 numbers a corner, is convex and its corners are in a plane.
bool is_convex(const float* corners, size_t count);

}  // namespace clarity
