// mesh_copy.hpp -- copies a mesh of an importer into the flat arrays of a Scene.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "rt_plugin.h"
#include "scene/scene.hpp"
#include "scene/triangulate.hpp"

namespace clarity::import {

// Number of faces in one file, and of those that were left out, by reason.
struct FaceCount {
    uint64_t all = 0, not_finite = 0, out_of_range = 0;
};

// Appends one mesh with its vertices and triangles to the scene. materials: the scene material of each id that the plugin
// received. Faces with unusable corners are left out and counted. Returns nothing, or why the mesh is refused (it is too
// large, or the plugin has a bug).
Problem copy_mesh(const rt_mesh& mesh, const std::vector<rt_u32>& materials, Scene& scene, Triangulator& triangulator,
                  FaceCount& faces);

}  // namespace clarity::import
