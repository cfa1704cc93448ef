// scene_digest.hpp -- tells whether two imported scenes make the same pictures.
#pragma once
#include <string>

#include "scene/scene.hpp"

namespace clarity::import {

// 32 hexadecimal digits, from all that the scene holds: geometry, materials, texels, lights, cameras, motion, edits. Left out
// are the places of its files, its warnings, and names by which nothing is chosen (of meshes, instances, materials, lights):
// the same files in another folder or on another machine have the same digest. Of numbered files of a sequence it holds the
// numbers, not the contents. Takes about as long as reading the scene's memory once. For any thread.
std::string scene_digest(const Scene& scene);

}  // namespace clarity::import
