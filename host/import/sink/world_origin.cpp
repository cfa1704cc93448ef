// The part of SceneBuilder that moves a scene far from the origin to it.
//
// Floats near 5e6 lie half a unit apart: a survey in UTM metres would lose its shape, and rays would start and hit in such
// steps. So where the whole world is far from 0, as seen by its own size, a point within it becomes the origin. It is
// subtracted in double precision from the transforms of instances, which hold what rounding took from them until here. The
// positions of meshes count from origins of their own (rt_mesh::origin), so they have their details still.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/numbers.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/sink/world_origin.hpp"
#include "scene/light_kinds.hpp"
#include "scene/motion/matrix.hpp"

namespace clarity::import {
namespace {

Matrix placed(const Instance& instance) {
    Matrix m = to_matrix(instance.world_from_object);
    for (int k = 0; k < 3; ++k) m[4 * k + 3] += instance.rounded_off[k];
    return m;
}

void subtract(const Vec& origin, float* p) {
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(p[k] - origin[k]);
}

std::string step_text(double coordinate) {
    char text[48];
    std::snprintf(text, sizeof text, "%.1g", std::ldexp(1.0, std::ilogb(coordinate) - 23));
    return text;
}

}  // namespace

void add_origin(Scene& scene, const Instance& instance, const std::array<double, 3>& more) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    float* const positions = scene.positions.own().data() + 3 * size_t(mesh.first_vertex);
    for (size_t i = 0; i < 3 * size_t(mesh.vertex_count); ++i)
        positions[i] = static_cast<float>(positions[i] + double(instance.world_from_object[4 * (i % 3) + 3]) + more[i % 3]);
}

void WorldBox::add(const Bounds& b, const Matrix& m) {
    for (int i = 0; i < 8 && !b.empty; ++i)
        add(point(m, {(i & 1 ? b.max : b.min)[0], (i & 2 ? b.max : b.min)[1], (i & 4 ? b.max : b.min)[2]}));
}

double WorldBox::farthest() const {
    double most = 0;
    for (int k = 0; k < 3; ++k) most = std::max({most, std::fabs(lo[k]), std::fabs(hi[k])});
    return most;
}

Vec origin_of(const WorldBox& box) {
    // A multiple of a power of two that is as large as the world: differences of floats from it are exact.
    const double grid = std::ldexp(1.0, std::ilogb(box.size()));
    Vec origin;
    for (int k = 0; k < 3; ++k) origin[k] = std::round((box.lo[k] + box.hi[k]) / 2 / grid) * grid;
    return origin;
}

void SceneBuilder::subtract_origin() {
    std::vector<Bounds> of_mesh(scene_.meshes.size());
    WorldBox box, mesh_box;
    bool has_digits = false, is_rounded = false;
    for (const Instance& instance : world_.instances) {
        Bounds& bounds = of_mesh[instance.mesh];
        const Mesh& mesh = scene_.meshes[instance.mesh];
        const rt_u32 unread = bounds.empty ? mesh.vertex_count : 0;
        for (rt_u32 v = 0; v < unread; ++v) bounds.add(&scene_.positions[3 * (size_t(mesh.first_vertex) + v)]);
        box.add(bounds, placed(instance));
        has_digits |= instance.rounded_off != std::array<double, 3>{};
        WorldBox own;
        own.add(bounds, kIdentityMatrix);
        if (own.is_far(kFar)) is_rounded = true, mesh_box = own;
    }
    for (const Sphere& s : world_.spheres)
        for (const double r : {-double(s.radius), double(s.radius)}) box.add(to_vec(s.center) + Vec{r, r, r});
    for (const FileContent::PolygonCorners& p : world_.polygons)
        for (size_t i = 0; i < p.corners.size(); i += 3) box.add(to_vec(&p.corners[i]));
    for (const Shape& shape : world_.shapes) box.add(shape_bounds(scene_, shape), to_matrix(shape.world_from_object));
    if (is_rounded)
        scene_.warnings.push_back("coordinates near " + exact_text(static_cast<float>(mesh_box.farthest())) +
                                  " are floats in the file, in steps of " + step_text(mesh_box.farthest()) +
                                  ": finer details are lost; write doubles or text, or subtract an origin before");
    if (box.size() > 0 && box.size() < kLeastSize)
        scene_.warnings.push_back("all surfaces lie within " + exact_text(static_cast<float>(box.size())) + ", less than " +
                                  exact_text(static_cast<float>(kLeastSize)) +
                                  ", where rays miss triangles: write lengths in a smaller unit, or scale the scene up");
    if (!box.is_far(has_digits ? kFarWithDigits : kFar)) {
        for (const Instance& instance : world_.instances) {
            WorldBox own;
            own.add(of_mesh[instance.mesh], placed(instance));
            const bool had_digits = instance.rounded_off != std::array<double, 3>{};
            if (!own.is_far(had_digits ? kFar : kFarAsNoShape)) continue;
            scene_.warnings.push_back("'" + instance.name + "' lies " + exact_text(static_cast<float>(own.farthest())) +
                                      " from the origin, but other objects are near it: its details are rounded to steps of " +
                                      step_text(own.farthest()));
            break;
        }
        return;
    }
    const Vec origin = origin_of(box);
    scene_.origin = origin;
    for (Instance& instance : world_.instances) {
        const Matrix m = placed(instance);
        for (int k = 0; k < 3; ++k) instance.world_from_object[4 * k + 3] = static_cast<float>(m[4 * k + 3] - origin[k]);
    }
    for (Node& node : world_.nodes)
        for (int k = 0; node.values.parent == RT_NONE && k < 3; ++k) node.values.translation[k] -= origin[k];
    for (Sphere& sphere : world_.spheres) subtract(origin, sphere.center.data());
    for (Plane& plane : world_.planes) plane.offset = static_cast<float>(plane.offset - dot(to_vec(plane.normal), origin));
    for (FileContent::PolygonCorners& polygon : world_.polygons)
        for (size_t i = 0; i < polygon.corners.size(); i += 3) subtract(origin, &polygon.corners[i]);
    for (Shape& shape : world_.shapes)
        for (int k = 0; k < 3; ++k)
            shape.world_from_object[4 * k + 3] = static_cast<float>(shape.world_from_object[4 * k + 3] - origin[k]);
    for (Light& light : world_.lights)
        if (light_kind_of(light.values).has_place) subtract(origin, light.values.position);
    for (Camera& camera : world_.cameras) {
        subtract(origin, camera.eye.data());
        subtract(origin, camera.target.data());
    }
}

}  // namespace clarity::import
