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

// The objects of one file on their way into another one.
struct Placing {
    SceneBuilder& builder;
    const std::string& from;
    const FileContent& content;
    const Placement& placement;
    FileContent& into;
    const rt_u32 root;  // node
    size_t lost = 0;

    const Affine& transform() const { return placement.world_from_object; }
    rt_u32 first_node() const { return root + 1; }
    rt_u32 material_of(rt_u32 own) const { return placement.material == RT_NONE ? own : placement.material; }
    std::string name_of(const std::string& own, bool alone) const {
        if (placement.name.empty()) return own;
        return alone || own.empty() ? placement.name : placement.name + "/" + own;
    }
    // Turns the node of an object of `content` into one of `into`.
    void hang(rt_u32& node) const {
        if (root == RT_NONE || (node == RT_NONE && placement.node == RT_NONE)) {
            node = RT_NONE;
        } else {
            node = node == RT_NONE ? root : node + first_node();
        }
    }
    template <class T>
    void keep(bool good, T object, std::vector<T>& list) {
        if (good)
            list.push_back(std::move(object));
        else
            ++lost;
    }

    std::vector<rt_u32> instances();  // returns their numbers in `into`
    void spheres();
    void planes();
    void polygons_and_shapes();
    void lights(std::vector<Light>& list);
    void cameras(std::vector<Camera>& list);
};

std::vector<rt_u32> Placing::instances() {
    std::vector<rt_u32> numbers;
    for (const Instance& own : content.instances) {
        Instance instance = own;
        instance.name = name_of(own.name, content.instances.size() == 1);
        instance.material = material_of(own.material);
        Matrix placed = to_matrix(own.world_from_object);
        for (int k = 0; k < 3; ++k) placed[4 * k + 3] += own.rounded_off[k];
        placed = to_matrix(transform()) * placed;
        instance.world_from_object = to_affine(placed);
        for (int k = 0; k < 3; ++k) instance.rounded_off[k] = placed[4 * k + 3] - double(instance.world_from_object[4 * k + 3]);
        if (own.node == RT_NONE) instance.node_from_object = own.world_from_object;
        hang(instance.node);
        if (instance.node != RT_NONE) instance.root = own.root == RT_NONE ? root : own.root + first_node();
        const bool good = are_usable(instance.world_from_object);
        numbers.push_back(good ? static_cast<rt_u32>(into.instances.size()) : RT_NONE);
        keep(good, std::move(instance), into.instances);
    }
    return numbers;
}

void Placing::spheres() {
    for (const Sphere& own : content.spheres) {
        bool uniform = true;
        const float scale = mean_scale(transform(), uniform);
        const Sphere sphere = {transform_point(transform(), own.center.data()), own.radius * scale, material_of(own.material)};
        if (!uniform)
            builder.warn(from, "a sphere is scaled differently along its axes; it stays a sphere, of the mean radius");
        keep(are_usable(sphere.center) && is_usable(sphere.radius) && sphere.radius > 0, sphere, into.spheres);
    }
}

void Placing::planes() {
    Affine inverse;
    const bool invertible = invert(transform(), inverse);
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
        const bool good = normalize(plane.normal) && is_usable(plane.offset);
        keep(good, plane, into.planes);
    }
}

void Placing::polygons_and_shapes() {
    Affine inverse;
    const bool invertible = invert(transform(), inverse);
    for (const FileContent::PolygonCorners& own : content.polygons) {
        FileContent::PolygonCorners polygon = {own.corners, material_of(own.material)};
        for (size_t i = 0; i < polygon.corners.size(); i += 3) {
            const std::array<float, 3> p = transform_point(transform(), &own.corners[i]);
            std::copy(p.begin(), p.end(), polygon.corners.begin() + static_cast<std::ptrdiff_t>(i));
        }
        const bool good = are_usable(polygon.corners) && invertible;
        keep(good, std::move(polygon), into.polygons);
    }
    for (Shape shape : content.shapes) {
        shape.material = material_of(shape.material);
        shape.world_from_object = multiply(transform(), shape.world_from_object);
        const bool good = are_usable(shape.world_from_object) && invert(shape.world_from_object, inverse);
        keep(good, shape, into.shapes);
    }
}

void Placing::lights(std::vector<Light>& list) {
    for (const auto* own : {&content.lights, &content.included_lights})
        for (Light light : *own) {
            light.name = name_of(light.name, false);
            if (light.node == RT_NONE) light.at_node = light.values;
            hang(light.node);
            if (move_light(light.values, to_matrix(transform()))) list.push_back(std::move(light));
        }
}

void Placing::cameras(std::vector<Camera>& list) {
    const Affine& m = transform();
    for (const auto* own : {&content.cameras, &content.included_cameras})
        for (Camera camera : *own) {
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
            if (make_sound(camera)) list.push_back(std::move(camera));
        }
}

}  // namespace

void SceneBuilder::place(const std::string& from, const FileContent& content, const Placement& placement, FileContent& into) {
    Placing placing{*this, from, content, placement, into, place_motion(content, placement, into)};
    const size_t lights_before = into.lights.size();
    const std::vector<rt_u32> numbers = placing.instances();
    placing.spheres();
    placing.planes();
    placing.polygons_and_shapes();
    const size_t fixed = content.spheres.size() + content.planes.size() + content.polygons.size() + content.shapes.size();
    if (placement.node != RT_NONE && fixed > 0)
        warn(from, std::to_string(fixed) +
                       " of its objects stay where they are at rest: spheres, planes, polygons and shapes " +
                       "cannot move; load a mesh for what should move");
    const bool is_root = &into == &world_;
    placing.lights(is_root ? into.lights : into.included_lights);
    placing.cameras(is_root ? into.cameras : into.included_cameras);
    place_edits(from, content, numbers, lights_before, into);
    if (placing.lost > 0)
        warn(from, std::to_string(placing.lost) +
                       " objects are left out: their transform is not finite, too large or without volume");
}

}  // namespace clarity::import
