// file_sequence.hpp -- meshes whose vertices come from numbered files.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"

namespace clarity {

// Adds the meshes of all sequences at a time. Between two files vertices move straight; before the first and after the last one
// they rest. Throws Error(import_failed) if a file does not have as many vertices as the first one.
void add_sequences(const Scene& scene, double time_s, const FrameVertices& read, std::vector<PosedMesh>& meshes);

// Adds the files from which the vertices at a time come: one or two of each sequence.
void add_sequence_files(const Scene& scene, double time_s, std::set<std::string>& files);

}  // namespace clarity
