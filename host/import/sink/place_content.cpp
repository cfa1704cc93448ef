// The half of SceneBuilder that places the objects of one file in another one.
#include <algorithm>
#include <cmath>

#include "import/sink/scene_builder.hpp"
#include "scene/camera.hpp"
#include "scene/light_kinds.hpp"
#include "scene/motion/matrix.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

// The geometric mean of the scale factors along the three axes. uniform: they are equal.
float mean_scale(const Affine& m, bool& uniform) {
    double lengths[3];
    for (int j = 0; j < 3; ++j) {
        lengths[j] = std::sqrt(double(m[j]) * m[j] + double(m[4 + j]) * m[4 + j] + double(m[8 + j]) * m[8 + j]);
    }
    const double scale = std::cbrt(lengths[0] * lengths[1] * lengths[2]);
    uniform = std::abs(lengths[0] - lengths[1]) <= 1e-4 * scale && std::abs(lengths[1] - lengths[2]) <= 1e-4 * scale;
    return static_cast<float>(scale);
}

std::array<float, 3> transform_direction(const Affine& m, const float* d) {
    return {m[0] * d[0] + m[1] * d[1] + m[2] * d[2], m[4] * d[0] + m[5] * d[1] + m[6] * d[2],
            m[8] * d[0] + m[9] * d[1] + m[10] * d[2]};
}

bool normalize(std::array<float, 3>& v) {
    const double length = std::sqrt(double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]);
    if (!(length > 0) || !std::isfinite(length)) return false;
    for (float& x : v) x = static_cast<float>(x / length);
    return true;
}

}  // namespace

void SceneBuilder::place(const std::string& from, const FileContent& content, const Placement& placement, FileContent& into) {
    const Affine& m = placement.world_from_object;
    const rt_u32 root = place_motion(content, placement, into), first_node = root + 1;
    const auto material_of = [&](rt_u32 own) { return placement.material == RT_NONE ? own : placement.material; };
    const auto name_of = [&](const std::string& own, bool alone) {
        if (placement.name.empty()) return own;
        return alone || own.empty() ? placement.name : placement.name + "/" + own;
    };
    // Turns the node of an object of `content` into one of `into`.
    const auto hang = [&](rt_u32& node) {
        if (root == RT_NONE || (node == RT_NONE && placement.node == RT_NONE)) {
            node = RT_NONE;
        } else {
            node = node == RT_NONE ? root : node + first_node;
        }
    };
    size_t lost = 0;
    std::vector<rt_u32> numbers;  // of the instances in `into`
    const size_t lights_before = into.lights.size();
    for (const Instance& own : content.instances) {
        Instance instance = own;
        instance.name = name_of(own.name, content.instances.size() == 1);
        instance.material = material_of(own.material);
        Matrix placed = to_matrix(own.world_from_object);
        for (int k = 0; k < 3; ++k) placed[4 * k + 3] += own.rounded_off[k];
        placed = to_matrix(m) * placed;
        instance.world_from_object = to_affine(placed);
        for (int k = 0; k < 3; ++k) instance.rounded_off[k] = placed[4 * k + 3] - double(instance.world_from_object[4 * k + 3]);
        if (own.node == RT_NONE) instance.node_from_object = own.world_from_object;
        hang(instance.node);
        if (instance.node != RT_NONE) instance.root = own.root == RT_NONE ? root : own.root + first_node;
        numbers.push_back(are_usable(instance.world_from_object) ? static_cast<rt_u32>(into.instances.size()) : RT_NONE);
        if (are_usable(instance.world_from_object)) {
            into.instances.push_back(std::move(instance));
        } else {
            ++lost;
        }
    }
    for (const Sphere& own : content.spheres) {
        bool uniform = true;
        const float scale = mean_scale(m, uniform);
        Sphere sphere = {transform_point(m, own.center.data()), own.radius * scale, material_of(own.material)};
        if (!uniform) warn(from, "a sphere is scaled differently along its axes; it stays a sphere, of the mean radius");
        if (are_usable(sphere.center) && is_usable(sphere.radius) && sphere.radius > 0) {
            into.spheres.push_back(sphere);
        } else {
            ++lost;
        }
    }
    Affine inverse;
    const bool invertible = invert(m, inverse);
    for (const Plane& own : content.planes) {
        // dot(n, x) = d with x = M^-1 y, so the normal is transformed by the inverse transpose.
        Plane plane = own;
        plane.material = material_of(own.material);
        float offset = own.offset;
        std::array<float, 3> normal{};
        for (int j = 0; j < 3 && invertible; ++j) {
            for (int i = 0; i < 3; ++i) normal[j] += own.normal[i] * inverse[4 * i + j];
            offset -= own.normal[j] * inverse[4 * j + 3];
        }
        const float length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        plane.normal = normal;
        plane.offset = offset / length;
        if (normalize(plane.normal) && is_usable(plane.offset)) {
            into.planes.push_back(plane);
        } else {
            ++lost;
        }
    }
    for (const FileContent::PolygonCorners& own : content.polygons) {
        FileContent::PolygonCorners polygon = {own.corners, material_of(own.material)};
        for (size_t i = 0; i < polygon.corners.size(); i += 3) {
            const std::array<float, 3> p = transform_point(m, &own.corners[i]);
            std::copy(p.begin(), p.end(), polygon.corners.begin() + static_cast<std::ptrdiff_t>(i));
        }
        if (are_usable(polygon.corners) && invertible) {
            into.polygons.push_back(std::move(polygon));
        } else {
            ++lost;
        }
    }
    for (Shape shape : content.shapes) {
        shape.material = material_of(shape.material);
        shape.world_from_object = multiply(m, shape.world_from_object);
        Affine back;
        if (are_usable(shape.world_from_object) && invert(shape.world_from_object, back)) {
            into.shapes.push_back(shape);
        } else {
            ++lost;
        }
    }
    const size_t fixed = content.spheres.size() + content.planes.size() + content.polygons.size() + content.shapes.size();
    if (placement.node != RT_NONE && fixed > 0)
        warn(from, std::to_string(fixed) +
                       " of its objects stay where they are at rest: spheres, planes, polygons and shapes " +
                       "cannot move; load a mesh for what should move");
    const bool is_root = &into == &world_;
    for (const auto* list : {&content.lights, &content.included_lights}) {
        for (Light light : *list) {
            light.name = name_of(light.name, false);
            if (light.node == RT_NONE) light.at_node = light.values;
            hang(light.node);
            const bool good = move_light(light.values, to_matrix(m));
            if (good) (is_root ? into.lights : into.included_lights).push_back(std::move(light));
        }
    }
    for (const auto* list : {&content.cameras, &content.included_cameras}) {
        for (Camera camera : *list) {
            camera.name = name_of(camera.name, false);
            if (camera.node == RT_NONE) {
                camera.node_eye = camera.eye;
                camera.node_target = camera.target;
                camera.node_up = camera.up;
            }
            hang(camera.node);
            camera.up = transform_direction(m, camera.up.data());
            camera.eye = transform_point(m, camera.eye.data());
            camera.target = transform_point(m, camera.target.data());
            if (make_sound(camera)) (is_root ? into.cameras : into.included_cameras).push_back(std::move(camera));
        }
    }
    place_edits(from, content, numbers, lights_before, into);
    if (lost > 0) {
        warn(from, std::to_string(lost) + " objects are left out: their transform is not finite, too large or without volume");
    }
}

}  // namespace clarity::import
