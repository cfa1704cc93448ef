// wire.hpp -- passes a Scene from the worker process to its parent, as one flat file in memory.
#pragma once
#include <string>

#include "base/files/memory_file.hpp"
#include "scene/scene.hpp"

namespace clarity::import {

// Writes the scene into an empty memfd and seals its size. The scene's memory goes back to the system piece by piece, so that
// it is not held twice. Returns an empty text on success, otherwise the reason.
std::string write_scene(int fd, Scene scene);

// Reads a scene that write_scene() wrote. This empties the file: the memory of what was read goes back to the system. The
// worker is not trusted: a file that is not sealed is refused, and every size is checked against the file's size. Each byte is
// read once, so that it does not matter if the worker still writes. Indices and numbers are not checked here but by validate().
// Returns an empty text on success, otherwise the reason.
std::string read_scene(int fd, Scene& scene);

// The scene of a file that write_scene() wrote and that has been sealed whole: its large arrays lie in the file, so that all
// processes that call this share one copy. Indices and numbers are not checked. Returns an empty text on success, otherwise the
// reason. Throws Error(failed) if the file cannot be mapped.
std::string map_scene(const MemoryFile& file, Scene& scene);

}  // namespace clarity::import
