// accel_build.hpp -- builds one acceleration structure over one scene: the builder's input, and its output, checked and packed.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "base/progress.hpp"
#include "plugin/parameters.hpp"
#include "rt_plugin.h"
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
    std::vector<uint32_t> flattened;  // instances of the Scene whose triangles were transformed into the world's group
    std::vector<rt_packed_prim> instance_leaves, spheres, polygons;  // by ref index
    std::vector<rt_polygon> polygon_table;
    std::vector<float> polygon_corners;  // 3 floats a corner
    std::vector<rt_plane> planes;
    Bounds bounds;  // of the world's group, that is of everything but planes
};
// Converts a scene. Throws Error(failed) if it has too many triangles, and Cancelled.
BuildScene make_build_scene(const Scene& scene, Progress& progress);

// Zeroed primitives behind the last leaf, because cl/primitives/triangle_row.h reads RT_ROW leaves from any leaf on.
constexpr uint64_t kLeafPadding = 3;

// A finished structure. Immutable.
struct AccelData {
    const rt_plugin* plugin = nullptr;
    ParameterValues params;
    struct Slot {
        AlignedBytes memory;
        uint64_t count = 0;
    };
    std::vector<Slot> slots;
    AlignedBytes leaves;  // rt_packed_prim in leaf order, then kLeafPadding zeroed ones
    uint64_t leaf_count = 0;
    std::vector<rt_u32> roots;  // one for each group
    std::map<std::string, rt_u32> defines;
    std::vector<std::pair<std::string, double>> stats;  // as the plugin reported them, in its order
    std::vector<rt_instance> instances;                 // with roots
    BuildScene scene;
    double build_ms = 0;  // time of the plugin's build() alone
    double pack_ms = 0;   // time of the conversion before and of checks and packing after it
    uint64_t bytes = 0;   // size of slots, leaves and instances
    // The plugin's statistic of that label, or `otherwise`.
    double stat(const std::string& label, double otherwise = 0) const;
};

// Runs a plugin's builder on a scene, on the calling thread and those that it starts. Throws Error(failed) "accel bvh2: why",
// and Cancelled. It also throws if the builder breaks its contract, for example by a missing root, a root or a ref out of
// range, a slot allocated twice, or an exception.
AccelData build_accel(const Scene& scene, const rt_plugin& plugin, const ParameterValues& params, Progress& progress);

// Bounding volumes of one tree level, in world space, for drawing.
struct Volumes {
    std::vector<std::array<std::array<float, 3>, 8>> boxes;  // 8 corners; bits 0, 1, 2 of the index: high x, y, z
    std::vector<std::array<float, 4>> spheres;               // centre and radius
};
// Returns at most `limit` volumes. Level 0 is the root, RT_LEVEL_BOTTOM the leaves. Empty if the plugin has no levels().
Volumes accel_volumes(const AccelData& accel, rt_u32 level, size_t limit);

}  // namespace clarity
