#include "ui/overlay/move_handles.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/angle.hpp"
#include "scene/motion/matrix.hpp"

namespace clarity::ui {
namespace {

constexpr float kArrow = 88, kArrowBegin = 14, kRing = 62, kSquareAt = 76;  // window units at scale 1
constexpr float kDisc = 9, kSquare = 7, kReach = 7;
constexpr int kRingSteps = 48;
constexpr float kEdgeOn = 0.08f;  // a plane is seen edge-on if the cosine to its normal is below this; so is an axis
constexpr auto kDegrees = static_cast<float>(1 / kRadPerDegree);

glm::vec3 axis_of(int k) {
    glm::vec3 axis{};
    axis[k] = 1;
    return axis;
}

int axis_of(MoveHandle handle) {
    const int number = static_cast<int>(handle);
    return number < 3 ? number : number - static_cast<int>(MoveHandle::turn_x);
}

float distance_to(const std::vector<glm::vec2>& line, const glm::vec2& p) {
    float nearest = 1e30f;
    for (size_t i = 0; i + 1 < line.size(); ++i) {
        const glm::vec2 along = line[i + 1] - line[i];
        const float squared = glm::dot(along, along);
        const float t = squared > 0 ? std::clamp(glm::dot(p - line[i], along) / squared, 0.0f, 1.0f) : 0;
        nearest = std::min(nearest, glm::length(p - line[i] - along * t));
    }
    return nearest;
}

// Where the ray of a window place comes nearest to a line, as a length along it.
std::optional<float> along_axis(const Projection& projection, const glm::vec2& mouse, const glm::vec3& point,
                                const glm::vec3& axis) {
    const glm::vec3 ray = projection.ray(mouse), between = point - projection.eye();
    const float cosine = glm::dot(ray, axis), sine_squared = 1 - cosine * cosine;
    if (sine_squared < kEdgeOn * kEdgeOn) return std::nullopt;
    return (cosine * glm::dot(between, ray) - glm::dot(between, axis)) / sine_squared;
}

// The angle about an axis of the place where the ray of a window place meets the plane across it.
std::optional<float> angle_about(const Projection& projection, const glm::vec2& mouse, const glm::vec3& point, int k) {
    const glm::vec3 ray = projection.ray(mouse), axis = axis_of(k);
    const float towards = glm::dot(ray, axis);
    if (std::abs(towards) < 1e-3f) return std::nullopt;
    const float t = glm::dot(point - projection.eye(), axis) / towards;
    if (!(t > 0)) return std::nullopt;
    const glm::vec3 at = projection.eye() + ray * t - point;
    return std::atan2(at[(k + 2) % 3], at[(k + 1) % 3]);
}

using Corners = std::array<std::array<float, 3>, 8>;

Corners corners_of(const Bounds& bounds, const Affine& place) {
    Corners corners;
    for (size_t i = 0; i < 8; ++i) {
        const float p[3] = {i & 1 ? bounds.max[0] : bounds.min[0], i & 2 ? bounds.max[1] : bounds.min[1],
                            i & 4 ? bounds.max[2] : bounds.min[2]};
        corners[i] = transform_point(place, p);
    }
    return corners;
}

}  // namespace

std::optional<MoveHandles> move_handles(const Projection& projection, const glm::vec3& middle, float scale) {
    const glm::vec3 seen = projection.to_camera(middle);
    if (seen.z < 4 * projection.near()) return std::nullopt;
    MoveHandles handles;
    handles.middle = middle;
    handles.centre = projection.to_window(seen);
    const float unit = projection.unit_at(seen.z) * scale;
    handles.length = kArrow * unit;
    const glm::vec3 to_eye = glm::normalize(projection.eye() - middle);
    for (int k = 0; k < 3; ++k) {
        const glm::vec3 axis = axis_of(k);
        const float cosine = std::abs(glm::dot(axis, to_eye));
        const auto begin = projection.place(middle + axis * (kArrowBegin * unit)),
                   end = projection.place(middle + axis * (kArrow * unit));
        if (begin && end && 1 - cosine * cosine > 4 * kEdgeOn * kEdgeOn) handles.lines[size_t(k)] = {*begin, *end};
        if (cosine < kEdgeOn) continue;
        // The half of the ring that faces the eye, without a gap: it begins where the ring turns away.
        std::vector<glm::vec2>& ring = handles.lines[static_cast<size_t>(MoveHandle::turn_x) + size_t(k)];
        const float facing = std::atan2(to_eye[(k + 2) % 3], to_eye[(k + 1) % 3]);
        const bool whole = cosine > 0.9f;
        const float half = whole ? float(kPi) : 1.72f;
        for (int i = 0; i <= kRingSteps; ++i) {
            const float angle = facing + half * (2 * float(i) / kRingSteps - 1);
            glm::vec3 p{};
            p[(k + 1) % 3] = std::cos(angle);
            p[(k + 2) % 3] = std::sin(angle);
            if (const auto place = projection.place(middle + p * (kRing * unit))) ring.push_back(*place);
        }
    }
    handles.lines[static_cast<size_t>(MoveHandle::view)] = {handles.centre, handles.centre};
    const glm::vec2 square = handles.centre + glm::vec2(kSquareAt, -kSquareAt) * scale;
    handles.lines[static_cast<size_t>(MoveHandle::scale)] = {square, square};
    return handles;
}

MoveHandle handle_at(const MoveHandles& handles, const glm::vec2& mouse, float scale) {
    MoveHandle best = MoveHandle::none;
    float nearest = kReach * scale;
    for (int i = 0; i < kMoveHandles; ++i) {
        const auto handle = static_cast<MoveHandle>(i);
        // The disc and the square count from their rims.
        const float rim = handle == MoveHandle::view ? kDisc : handle == MoveHandle::scale ? kSquare : 0;
        const float away = distance_to(handles.lines[size_t(i)], mouse) - rim * scale;
        if (away < nearest) {
            nearest = away;
            best = handle;
        }
    }
    return best;
}

std::optional<glm::vec2> grab_place(const MoveHandles& handles, MoveHandle handle) {
    if (handle == MoveHandle::none) return std::nullopt;
    const std::vector<glm::vec2>& line = handles.lines[static_cast<size_t>(handle)];
    if (line.empty()) return std::nullopt;
    if (line.size() > 2) return line[line.size() / 8];  // of a ring: not where two of them meet
    return line.front() + (line.back() - line.front()) * 0.8f;
}

InstanceShift dragged(const MoveDrag& drag, const Projection& projection, const glm::vec2& mouse) {
    InstanceShift shift = drag.start;
    const int k = drag.handle == MoveHandle::none ? 0 : axis_of(drag.handle);
    switch (drag.handle) {
        case MoveHandle::none:
            break;
        case MoveHandle::x:
        case MoveHandle::y:
        case MoveHandle::z: {
            const auto from = along_axis(projection, drag.from, drag.middle, axis_of(k)),
                       to = along_axis(projection, mouse, drag.middle, axis_of(k));
            if (from && to) shift.translate[size_t(k)] += *to - *from;
            break;
        }
        case MoveHandle::view: {
            const float unit = projection.unit_at(projection.to_camera(drag.middle).z);
            const glm::vec2 moved = (mouse - drag.from) * unit;
            const glm::vec3 by = projection.to_world({moved.x, -moved.y, 0}) - projection.eye();
            for (int i = 0; i < 3; ++i) shift.translate[size_t(i)] += by[i];
            break;
        }
        case MoveHandle::turn_x:
        case MoveHandle::turn_y:
        case MoveHandle::turn_z: {
            const auto from = angle_about(projection, drag.from, drag.middle, k),
                       to = angle_about(projection, mouse, drag.middle, k);
            if (!from || !to) break;
            Vec by{};
            by[size_t(k)] = double(*to - *from) * kDegrees;
            const Quaternion turned = from_angles(by, RT_ROTATE_XYZ) * from_angles(to_vec(drag.start.degrees), RT_ROTATE_XYZ);
            const Vec degrees = to_angles(turned, RT_ROTATE_XYZ);
            for (size_t i = 0; i < 3; ++i) shift.degrees[i] = static_cast<float>(degrees[i]);
            break;
        }
        case MoveHandle::scale: {
            const auto centre = projection.place(drag.middle);
            if (!centre) break;
            const float before = std::max(glm::length(drag.from - *centre), 1.0f), now = glm::length(mouse - *centre);
            const float factor = std::clamp(now / before, 0.01f, 100.0f);
            for (float& s : shift.scale) s *= factor;
            break;
        }
    }
    return shift;
}

std::array<std::array<float, 3>, 8> SelectionBox::corners() const {
    return corners_of(own, place);
}

std::optional<SelectionBox> selection_box(const Scene& scene, const Selection& selection, const PosedMesh* vertices) {
    Bounds bounds;
    if (selection.instance >= 0 && static_cast<size_t>(selection.instance) < scene.instances.size()) {
        const Instance& instance = scene.instances[static_cast<size_t>(selection.instance)];
        const Mesh& mesh = scene.meshes[instance.mesh];
        const float* const positions = vertices ? vertices->positions.data() : &scene.positions[size_t{3} * mesh.first_vertex];
        for (size_t v = 0; v < mesh.vertex_count; ++v) bounds.add(positions + 3 * v);
        if (bounds.empty) return std::nullopt;
        return SelectionBox{bounds, instance.world_from_object};
    }
    const PrimPlace place = place_of_prim(scene, selection.prim);
    if (place.kind == PrimPlace::Kind::sphere) {
        const Sphere& sphere = scene.spheres[place.index];
        for (const float side : {-1.0f, 1.0f}) {
            float corner[3];
            for (size_t i = 0; i < 3; ++i) corner[i] = sphere.center[i] + side * sphere.radius;
            bounds.add(corner);
        }
    } else if (place.kind == PrimPlace::Kind::polygon) {
        const Polygon& polygon = scene.polygons[place.index];
        for (rt_u32 i = 0; i < polygon.corner_count; ++i)
            bounds.add(&scene.polygon_corners[size_t{3} * (polygon.first_corner + i)]);
    }
    if (place.kind == PrimPlace::Kind::shape) {
        const Shape& shape = scene.shapes[place.index];
        return SelectionBox{shape_bounds(scene, shape), shape.world_from_object};
    }
    if (bounds.empty) return std::nullopt;
    return SelectionBox{bounds, kIdentity};
}

}  // namespace clarity::ui
