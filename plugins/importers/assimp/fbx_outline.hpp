// fbx_outline.hpp -- reads the parts of an FBX file that assimp 5.2 does not pass on: the materials of each node, and the order
// of its rotations. It reads binary and ASCII files of version 7, and skips arrays.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace assimp_import {

struct FbxOutline {
    struct Model {
        std::string name;
        int rotation_order = 0;  // 0: XYZ
        // If false, pre- and post-rotation and the rotation order do not count.
        bool rotation_active = false;
        std::array<double, 3> translation{}, rotation{}, scaling = {1, 1, 1};  // rotation in degrees
        std::array<double, 3> geometric_rotation{};                            // degrees
        std::vector<int64_t> children, materials;                              // object ids, in the order of their connections
    };
    struct Material {
        std::string name;
        std::unordered_map<std::string, std::array<double, 3>> properties;  // for example "DiffuseColor", "ShininessExponent"
        std::string texture;                                                // file of the diffuse colour's texture, or empty
    };
    std::unordered_map<int64_t, Model> models;
    std::unordered_map<int64_t, Material> materials;
    std::vector<int64_t> roots;
};

// Reads the outline. In a damaged file, it ends at the damage.
FbxOutline read_fbx_outline(std::string_view bytes);

}  // namespace assimp_import
