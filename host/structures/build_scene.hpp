// build_scene.hpp -- a scene as builders of structures see it.
#pragma once
#include <cstdint>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "base/members.hpp"
#include "base/progress.hpp"
#include "rt_plugin.h"
#include "rt_shape.h"
#include "scene/scene.hpp"

namespace clarity {

// A scene as builders see it: boxes of primitives in groups. Group 0 is the world; each instanced mesh has one group more. A
// mesh that is placed only once is flattened into the world.
struct BuildScene {
    UninitializedVector<rt_prim> prims;  // like the triangles, empty after the build
    std::vector<rt_group> groups;
    UninitializedVector<rt_packed_prim> triangles;  // by ref index, in the space of their group
    std::vector<rt_instance> instances;             // with roots unset
    std::vector<uint32_t> group_of_instance;
    std::vector<Affine> world_from_object;             // for each instance
    UninitializedVector<uint32_t> attribute_triangle;  // from a triangle's ref to its number in the Scene
    std::vector<uint32_t> flattened;  // instances of the Scene; their triangles were transformed into the world's group
    std::vector<rt_packed_prim> instance_leaves, spheres, polygons, shape_leaves;  // by ref index
    std::vector<rt_shape> shapes;                                                  // parts of all placed shapes, by ref index
    std::vector<rt_polygon> polygon_table;
    std::vector<float> polygon_corners;  // 3 floats a corner
    std::vector<rt_plane> planes;
    Bounds bounds;         // of the world's group, that is of everything but planes
    Bounds object_bounds;  // of all other groups, each in the space of its mesh
    // Where the Scene's meshes and instances are in here, for scenes that move.
    std::vector<rt_u32> group_of_mesh;       // 0: its triangles are in the world's group, or nowhere
    std::vector<rt_u32> first_ref_of_group;  // ref of the group's first triangle; the others follow
    std::vector<rt_u32> number_of_instance;  // in `instances`; RT_NONE: flattened, or not visible
    CLARITY_MEMBERS(prims, groups, triangles, instances, group_of_instance, world_from_object, attribute_triangle, flattened,
                    instance_leaves, spheres, polygons, shape_leaves, shapes, polygon_table, polygon_corners, planes, bounds,
                    object_bounds, group_of_mesh, first_ref_of_group, number_of_instance);
};
// True if a builder of that scene was given such a ref.
inline bool is_known_ref(rt_u32 ref, const BuildScene& scene) {
    const rt_u32 index = RT_REF_INDEX(ref);
    switch (RT_REF_KIND(ref)) {
        case RT_REF_TRIANGLE:
            return index < scene.triangles.size();
        case RT_REF_SPHERE:
            return index < scene.spheres.size();
        case RT_REF_POLYGON:
            return index < scene.polygons.size();
        case RT_REF_SHAPE:
            return index < scene.shapes.size();
        case RT_REF_INSTANCE:
            return index < scene.instances.size();
    }
    return false;
}
// The box of a primitive, as builders get it. `packed` is what leaves hold of it.
rt_prim box_of(const BuildScene& scene, const rt_packed_prim& packed);
// The box in the world of an instance of what lies in `box`, with the ref of this number.
rt_prim box_of_instance(const Bounds& box, const Affine& world_from_object, const Affine& object_from_world, rt_u32 number);
// Whether a transform contains a reflection (negative determinant): such an instance is never flattened.
bool mirrors(const Affine& world_from_object);
// rt_instance::hidden of an instance that is visible, or is not.
rt_u32 hidden_from(const Instance& instance, bool visible);

// Converts a scene. Throws Error(failed) if it has too many triangles, and Cancelled.
BuildScene make_build_scene(const Scene& scene, Progress& progress);

}  // namespace clarity
