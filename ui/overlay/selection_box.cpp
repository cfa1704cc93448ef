#include "ui/overlay/selection_box.hpp"

namespace clarity::ui {
namespace {

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
