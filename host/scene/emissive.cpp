#include "scene/emissive.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity {

bool is_convex(const float* corners, size_t count) {
    Vec normal{};
    const auto at = [&](size_t i) { return to_vec(corners + 3 * (i % count)); };
    for (size_t i = 2; i < count; ++i) normal = normal + cross(at(i - 1) - at(0), at(i) - at(0));
    const double size = length(normal);
    if (!(size > 0)) return false;
    normal = (1 / size) * normal;
    // Every corner turns the same way, once around, and is in the plane.
    double turned = 0;
    for (size_t i = 0; i < count; ++i) {
        const Vec before = at(i + count - 1), here = at(i), after = at(i + 1), in = here - before, out = after - here;
        if (std::fabs(dot(normal, here - at(0))) > 1e-4 * std::sqrt(size)) return false;
        const double sine = dot(normal, cross(in, out));
        if (sine < -1e-6 * length(in) * length(out)) return false;
        turned += std::atan2(sine, dot(in, out));
    }
    return turned < 3 * kPi;
}

EmissiveCounts count_emissive(const Scene& scene) {
    std::vector<bool> emits;
    for (const Material& material : scene.materials)
        emits.push_back(std::any_of(std::begin(material.values.emission), std::end(material.values.emission),
                                    [](float channel) { return channel > 0; }));
    EmissiveCounts counts;
    std::vector<uint64_t> of_mesh;  // triangles whose own material emits
    for (const Mesh& mesh : scene.meshes) {
        of_mesh.push_back(0);
        for (rt_u32 i = 0; i < mesh.triangle_count; ++i)
            of_mesh.back() += emits[scene.triangle_materials[mesh.first_triangle + i]];
    }
    for (const Instance& instance : scene.instances) {
        if (!instance.visible) continue;
        if (instance.material == RT_NONE)
            counts.triangles += of_mesh[instance.mesh];
        else if (emits[instance.material])
            counts.triangles += scene.meshes[instance.mesh].triangle_count;
    }
    for (const Sphere& sphere : scene.spheres) counts.spheres += emits[sphere.material];
    for (const Polygon& polygon : scene.polygons) {
        if (!emits[polygon.material]) continue;
        const float* const corners = &scene.polygon_corners[3 * size_t(polygon.first_corner)];
        ++(is_convex(corners, polygon.corner_count) ? counts.polygons : counts.bent_polygons);
    }
    for (const Plane& plane : scene.planes) counts.planes += emits[plane.material];
    for (const Shape& shape : scene.shapes) counts.shapes += emits[shape.material];
    return counts;
}

}  // namespace clarity
