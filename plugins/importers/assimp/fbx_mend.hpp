// fbx_mend.hpp -- corrects errors of assimp 5.2 in FBX scenes with the help of the file's outline.
#pragma once
#include <assimp/scene.h>

#include <string>
#include <unordered_map>
#include <vector>

#include "fbx_outline.hpp"

namespace assimp_import {

// What the file means, and what assimp does instead:
// - Pre- and post-rotation and the rotation order count only if RotationActive is set; otherwise the order is XYZ. assimp
//   always applies them.
// - The order of GeometricRotation is always XYZ. assimp uses the node's rotation order.
// - Each node has its own materials. assimp gives all nodes that share a mesh the materials of the first one.
class FbxMend {
 public:
    // Reads `path` again, corrects rotations in the scene, and adds materials that assimp left out. If the outline does not
    // match the scene, nothing changes.
    FbxMend(aiScene& scene, const std::string& path);

    // Returns the material (index in the scene) that this node gives to each of its meshes. Empty: the materials of assimp's
    // meshes are right.
    std::vector<unsigned> materials(const aiNode& node) const;

 private:
    bool match(const aiScene& scene);
    void mend_rotations();
    void mend_materials(aiScene& scene);
    unsigned material_index(aiScene& scene, int64_t id);

    FbxOutline outline_;
    std::unordered_map<const aiNode*, const FbxOutline::Model*> models_;
    std::vector<aiNode*> order_;                                       // nodes with a model, parents first
    std::unordered_map<const aiNode*, std::vector<aiNode*>> helpers_;  // nodes that make up a node's transform, outermost first
    std::unordered_map<const aiNode*, std::vector<unsigned>> materials_;
    std::unordered_map<int64_t, unsigned> material_indices_;
};

}  // namespace assimp_import
