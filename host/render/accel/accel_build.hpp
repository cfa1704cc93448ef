// accel_build.hpp -- one acceleration structure over one scene: what the builder reads, what it wrote, checked and packed.
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

// A scene as builders see it: boxes in groups, one group for the world and one for each mesh that is instanced. Meshes placed
// once are flattened into the world.
struct BuildScene {
    UninitializedVector<rt_prim> prims;  // empty once it is built, and so are the triangles
    std::vector<rt_group> groups;
    UninitializedVector<rt_packed_prim> triangles;  // by ref index, in the space of its group
    std::vector<rt_instance> instances;             // roots unset
    std::vector<uint32_t> group_of_instance;
    std::vector<Affine> world_from_object;             // per instance
    UninitializedVector<uint32_t> attribute_triangle;  // triangle ref -> triangle of the Scene
    std::vector<uint32_t> flattened;                   // instances of the Scene that stand in the world's group, moved
    std::vector<rt_packed_prim> instance_leaves, spheres, polygons;  // by ref index
    std::vector<rt_polygon> polygon_table;
    std::vector<float> polygon_corners;  // 3 per corner
    std::vector<rt_plane> planes;
    Bounds bounds;  // of the world's group: all but planes
};
BuildScene make_build_scene(const Scene& scene, Progress& progress);

// cl/primitives/triangle_row.h reads RT_ROW leaves from any on.
constexpr uint64_t kLeafPadding = 3;

// A finished structure, immutable.
struct AccelData {
    const rt_plugin* plugin = nullptr;
    ParameterValues params;
    struct Slot {
        AlignedBytes memory;
        uint64_t count = 0;
    };
    std::vector<Slot> slots;
    AlignedBytes leaves;  // rt_packed_prim, in leaf order, then kLeafPadding of zeros
    uint64_t leaf_count = 0;
    std::vector<rt_u32> roots;  // one a group
    std::map<std::string, rt_u32> defines;
    std::vector<std::pair<std::string, double>> stats;  // as the plugin reported them, in its order
    std::vector<rt_instance> instances;                 // with roots
    BuildScene scene;
    double build_ms = 0;  // the plugin's build() alone
    double pack_ms = 0;
    uint64_t bytes = 0;  // slots and leaves
    double stat(const std::string& label, double otherwise = 0) const;
};

// Runs a plugin's builder on a scene. Throws Error(failed) "accel bvh2: why", also where the builder broke the contract: no
// root for a group, a root or a ref out of range, a slot allocated twice, an exception. Cancelled.
AccelData build_accel(const Scene& scene, const rt_plugin& plugin, const ParameterValues& params, Progress& progress);

// Bounding volumes of one level in world space, for drawing.
struct Volumes {
    std::vector<std::array<std::array<float, 3>, 8>> boxes;  // corners; bit 0 of the index: x high, bit 1: y, bit 2: z
    std::vector<std::array<float, 4>> spheres;               // centre, radius
};
// level 0 is the root, RT_LEVEL_BOTTOM the leaves. At most `limit` volumes.
Volumes accel_volumes(const AccelData& accel, rt_u32 level, size_t limit);

}  // namespace clarity
