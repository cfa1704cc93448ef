// mesh_copy.hpp -- a mesh as an importer hands it over, into the flat arrays of a Scene.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_plugin.h"
#include "scene/scene.hpp"
#include "scene/triangulate.hpp"

namespace clarity::import {

// Coordinates beyond this count as not finite: areas of boxes and their sums over all primitives still fit in a float.
inline constexpr float kMaxCoordinate = 1e15f;

inline bool is_usable(float coordinate) {
    return coordinate <= kMaxCoordinate && coordinate >= -kMaxCoordinate;
}

// Faces of one file, and those of them that were left out.
struct FaceCount {
    uint64_t all = 0, not_finite = 0, out_of_range = 0;
};

// Appends one mesh with its vertices and triangles. materials: scene material of each id that the plugin was given. Faces with
// unusable corners are left out and counted. Returns why the mesh is refused (a bug of the plugin, or too large), or empty.
std::string copy_mesh(const rt_mesh& mesh, const std::vector<rt_u32>& materials, Scene& scene, Triangulator& triangulator,
                      FaceCount& faces);

}  // namespace clarity::import
