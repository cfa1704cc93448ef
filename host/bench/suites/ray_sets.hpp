// ray_sets.hpp -- the rays that everybody traces: made once on the host, the same for structures, settings, devices and peers.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bench/suites/vec3.hpp"
#include "render/frame/renderer.hpp"

namespace clarity::bench {

// Rays in an order that suits packets of any size up to 16x16 pixels: tiles of 16x16 in rows, Z-order within, so that any 4, 8
// or 16 in a row are 2x2, 4x2 or 4x4 pixels. Rays of pixels that have none (beyond the picture's edge, or where the camera ray
// met nothing) stay in their place and are inactive: t_max = -1, direction that of a neighbour. Only active ones count as rays.
struct RaySet {
    std::string kind;      // primary | shadow | reflection | diffuse
    bool any_hit = false;  // shadow: whether anything lies before t_max
    std::vector<rt_ray> rays;
    uint64_t active = 0;
};
inline bool is_active(const rt_ray& ray) {
    return ray.t_max >= 0;
}

// Pixel y * width + x of each ray; RT_NONE beyond the edge.
std::vector<rt_u32> ray_order(int width, int height);

// Through the pixel centres.
RaySet camera_rays(const Camera& camera, int width, int height);

// What the hits of the camera rays lead to; origins lie eps above the surface along the geometric normal that faces the viewer,
// eps being 1e-4 of the diagonal of the scene's bounds.
//   shadow      to the light's position (or along a directional light), unit direction; t_max is the distance
//   reflection  the mirror direction by the geometric normal
//   diffuse     one direction, cosine-weighted by lowbias32 of 2 pixel + 1 and 2 pixel + 2
std::vector<RaySet> secondary_rays(const Scene& scene, const rt_light& light, const RaySet& primary,
                                   const std::vector<rt_hit>& hits, int width, int height);

// Geometric normals by the number that rt_hit.prim carries: triangles of all instances, then spheres, polygons, planes.
class SurfaceNormals {
 public:
    explicit SurfaceNormals(const Scene& scene);
    // Unit, either side, at a point of the primitive; (0, 1, 0) for one without area.
    Vec3 at(rt_i32 prim, const Vec3& point) const;

 private:
    const Scene& scene_;
    std::vector<uint64_t> first_prim_;  // of each instance, and the end
};

// Wellons 2018, "Prospecting for Hash Functions": a 32-bit mix of low bias.
uint32_t lowbias32(uint32_t x);

}  // namespace clarity::bench
