// fbx_mend.hpp -- what assimp 5.2 gets wrong in FBX scenes and the file's outline can put right.
#pragma once
#include <assimp/scene.h>

#include <string>
#include <unordered_map>
#include <vector>

#include "fbx_outline.hpp"

namespace assimp_import {

// - Pre- and post-rotation and the rotation order count only where RotationActive is set; else the order is XYZ.
// - GeometricRotation is turned in the node's rotation order; it is always XYZ.
// - Nodes that share a mesh all get the materials of the first.
class FbxMend {
 public:
    // Looks into `path` again. Corrects rotations in the scene, and adds materials to it that assimp left out.
    FbxMend(aiScene& scene, const std::string& path);

    // For each of the node's meshes the material that this node gives it (an index into the scene's); empty: as assimp says.
    std::vector<unsigned> materials(const aiNode& node) const;

 private:
    bool match(const aiScene& scene);
    void mend_rotations();
    void mend_materials(aiScene& scene);
    unsigned material_index(aiScene& scene, int64_t id);

    FbxOutline outline_;
    std::unordered_map<const aiNode*, const FbxOutline::Model*> models_;
    std::vector<aiNode*> order_;                                       // nodes with a model, parents first
    std::unordered_map<const aiNode*, std::vector<aiNode*>> helpers_;  // of a node's transform, outermost first
    std::unordered_map<const aiNode*, std::vector<unsigned>> materials_;
    std::unordered_map<int64_t, unsigned> material_indices_;
};

}  // namespace assimp_import
