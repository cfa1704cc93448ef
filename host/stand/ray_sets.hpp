// ray_sets.hpp -- rays that are made on the host, so that all structures, settings, devices and baselines trace the same ones.
#pragma once
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "stand/triangle_mesh.hpp"

namespace clarity {

inline rt_ray ray_of(const Point& origin, const Point& direction, float t_min = 0, float t_max = INFINITY) {
    return {{origin[0], origin[1], origin[2]}, t_min, {direction[0], direction[1], direction[2]}, t_max};
}

// Where rays are aimed.
struct Region {
    const char* name;
    Point center;
    float radius;
};

// Rays by chance, with directions of unit length.
class RayMaker {
 public:
    RayMaker(unsigned own, uint64_t seed);
    float any();  // 0 to 1
    size_t below(size_t n);
    Point direction();
    Point within(const Region& region, float share = 1);  // of a cube of twice the radius
    static rt_ray from_to(const Point& from, const Point& to);
    // A ray from `away` radii outside to a point of the region.
    rt_ray into(const Region& region, float away) { return along(direction(), region, away); }
    rt_ray along(const Point& direction, const Region& region, float away);

 private:
    std::mt19937 random_;
};

// Origins in and around the box, and directions all over the sphere; half of these are up to ten long.
std::vector<rt_ray> random_rays(const Bounds& box, size_t count, unsigned seed);

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
    Vec at(rt_i32 prim, const Vec& point) const;
    // Shapes have no normal here.
    bool is_shape(rt_i32 prim) const;

 private:
    const Scene& scene_;
    const PrimNumbers numbers_;
};

}  // namespace clarity
