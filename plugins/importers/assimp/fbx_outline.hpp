// fbx_outline.hpp -- the little of an FBX file that assimp 5.2 does not hand on: which materials each node has, and the order
// of its rotations. Binary and ASCII, 7.x; arrays are skipped.
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
        // Without it, pre- and post-rotation and the rotation order do not count.
        bool rotation_active = false;
        std::array<double, 3> translation{}, rotation{}, scaling = {1, 1, 1};  // degrees
        std::array<double, 3> geometric_rotation{};                            // degrees
        std::vector<int64_t> children, materials;                              // object ids, in the order of their connections
    };
    struct Material {
        std::string name;
        std::unordered_map<std::string, std::array<double, 3>> properties;  // "DiffuseColor", "ShininessExponent"...
        std::string texture;                                                // of the diffuse colour, or empty
    };
    std::unordered_map<int64_t, Model> models;
    std::unordered_map<int64_t, Material> materials;
    std::vector<int64_t> roots;
};

// What could be read; damage ends the outline where it stands.
FbxOutline read_fbx_outline(std::string_view bytes);

}  // namespace assimp_import
