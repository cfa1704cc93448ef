#include "scene/emissive.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity {

bool emits(const rt_material& material) {
    return !is_black(material.emission);
}

bool is_drawn(const MaterialValues& values, const Material& own) {
    if (values.alpha != RT_ALPHA_OPAQUE) return false;
    const bool varnished = values.model == RT_MODEL_GLTF && values.layers.clearcoat > 0;
    return !varnished || (own.maps[RT_MAP_CLEARCOAT] == RT_NONE && own.maps[RT_MAP_CLEARCOAT_ROUGHNESS] == RT_NONE);
}

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
    std::vector<bool> emitting, is_cut_out;
    for (const Material& material : scene.materials) {
        emitting.push_back(emits(material.values));
        is_cut_out.push_back(!is_drawn(material.values, material));
    }
    EmissiveCounts counts;
    const auto count = [&](rt_u32 material, uint64_t number, uint64_t& whole) {
        if (emitting[material]) (is_cut_out[material] ? counts.cut_out : whole) += number;
    };
    std::vector<EmissiveCounts> of_mesh(scene.meshes.size());  // of triangles with a material of their own
    for (size_t m = 0; m < scene.meshes.size(); ++m)
        for (rt_u32 i = 0; i < scene.meshes[m].triangle_count; ++i) {
            const rt_u32 material = scene.triangle_materials[scene.meshes[m].first_triangle + i];
            if (emitting[material]) ++(is_cut_out[material] ? of_mesh[m].cut_out : of_mesh[m].triangles);
        }
    for (const Instance& instance : scene.instances) {
        if (!instance.visible) continue;
        if (instance.material != RT_NONE) {
            count(instance.material, scene.meshes[instance.mesh].triangle_count, counts.triangles);
        } else {
            counts.triangles += of_mesh[instance.mesh].triangles;
            counts.cut_out += of_mesh[instance.mesh].cut_out;
        }
    }
    for (const Sphere& sphere : scene.spheres) count(sphere.material, 1, counts.spheres);
    for (const Polygon& polygon : scene.polygons) {
        if (!emitting[polygon.material]) continue;
        const float* const corners = &scene.polygon_corners[3 * size_t(polygon.first_corner)];
        count(polygon.material, 1, is_convex(corners, polygon.corner_count) ? counts.polygons : counts.bent_polygons);
    }
    for (const Plane& plane : scene.planes) count(plane.material, 1, counts.planes);
    for (const Shape& shape : scene.shapes) count(shape.material, 1, counts.shapes);
    return counts;
}

}  // namespace clarity
