// meshes.hpp -- the meshes of a node as one mesh of the host, shared by all nodes that have the same.
#pragma once
#include <assimp/scene.h>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "materials.hpp"
#include "rt_plugin.h"

namespace assimp_import {

// assimp splits a mesh by material; here the parts become one mesh with a material per face again. Corners that agree in all
// they have become one vertex (the FBX importer hands out one per corner).
class MeshTable {
 public:
    MeshTable(const aiScene& scene, MaterialTable& materials, const rt_scene_sink& sink)
        : scene_(scene), materials_(materials), sink_(sink) {}
    struct Placed {
        rt_u32 mesh = RT_NONE;      // RT_NONE: the node shows no polygons
        rt_u32 material = RT_NONE;  // of the whole instance; RT_NONE: the mesh's own
    };
    // The mesh made of a node's meshes. `materials`: one for each of them instead of their own, or empty.
    Placed place(const aiNode& node, const std::vector<unsigned>& materials);

    // What was left out.
    uint64_t points_and_lines() const { return points_and_lines_; }
    uint64_t broken_faces() const { return broken_faces_; }
    uint64_t faces() const { return faces_; }

 private:
    // A mesh of the scene and its material.
    using Part = std::pair<unsigned, unsigned>;
    rt_u32 id(const std::vector<Part>& parts, const aiNode& node);
    rt_u32 add(const std::vector<Part>& parts, const char* name);

    const aiScene& scene_;
    MaterialTable& materials_;
    const rt_scene_sink& sink_;
    std::map<std::vector<Part>, rt_u32> ids_;
    uint64_t points_and_lines_ = 0, broken_faces_ = 0, faces_ = 0;
};

}  // namespace assimp_import
