// ray_sets.hpp -- the rays of the ray benchmarks. They are made once on the host, so that all structures, settings, devices and
// baselines trace the same rays.
#pragma once
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::bench {

// Vectors in double precision, for rays and meshes made on the host.

using Vec3 = glm::dvec3;

// Unit vector. Returns `otherwise` for the zero vector, for which glm::normalize() returns NaN.
inline Vec3 normalized(const Vec3& a, const Vec3& otherwise) {
    const double length = glm::length(a);
    return length > 0 ? (1 / length) * a : otherwise;
}

// Rays in an order which suits packets of up to 16x16 pixels: tiles of 16x16 pixels in rows, Z-order within a tile. Any 4, 8 or
// 16 consecutive rays are thus 2x2, 4x2 or 4x4 pixels. A pixel without a ray (beyond the picture's edge, or where the camera
// ray hit nothing) keeps its place with an inactive ray: t_max = -1, origin and direction of a neighbour. Only active rays
// count.
struct RaySet {
    std::string kind;      // primary | shadow | reflection | diffuse
    bool any_hit = false;  // true for shadow rays: the query is whether anything lies before t_max
    std::vector<rt_ray> rays;
    uint64_t active = 0;  // number of active rays
};
inline bool is_active(const rt_ray& ray) {
    return ray.t_max >= 0;
}

// Pixel of each ray as y * width + x; RT_NONE beyond the picture's edge.
std::vector<rt_u32> ray_order(int width, int height);

// One ray through the centre of each pixel.
RaySet camera_rays(const Camera& camera, int width, int height);

// Traces rays on a device, for their nearest hits.
using TraceRays = std::function<std::vector<rt_hit>(const std::vector<rt_ray>&)>;

// Makes the secondary rays of the camera rays' hits. Normals of shapes, which only kernels know, are found by further rays.
// Origins lie eps above the surface, along the geometric normal which faces the viewer. eps is 1e-4 of the diagonal of the
// scene's bounds.
//   shadow      to the light's position (or along a directional light), unit direction; t_max is the distance
//   reflection  the mirror direction by the geometric normal
//   diffuse     one direction, cosine-weighted; its random numbers are lowbias32(2 pixel + 1) and lowbias32(2 pixel + 2)
std::vector<RaySet> secondary_rays(const Scene& scene, const rt_light& light, const RaySet& primary, int width, int height,
                                   const TraceRays& trace);

// Geometric normals by the index which rt_hit.prim holds: triangles of all instances, then spheres, polygons and planes. Keeps
// a reference to the scene.
class SurfaceNormals {
 public:
    explicit SurfaceNormals(const Scene& scene) : scene_(scene), numbers_(scene) {}
    // Unit normal at a point of the primitive, on either side of it; (0, 1, 0) for a primitive without area.
    Vec3 at(rt_i32 prim, const Vec3& point) const;
    // Shapes have no normal here.
    bool is_shape(rt_i32 prim) const;

 private:
    const Scene& scene_;
    const PrimNumbers numbers_;
};

// 32-bit hash of low bias: Wellons 2018, "Prospecting for Hash Functions".
uint32_t lowbias32(uint32_t x);

}  // namespace clarity::bench
