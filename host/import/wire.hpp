// wire.hpp -- passes a Scene from the worker process to its parent, as one flat file in memory.
#pragma once
#include <string>

#include "scene/scene.hpp"

namespace clarity::import {

// Writes the scene into an empty memfd and seals it against any later change. Returns an empty text on success, otherwise the
// reason.
std::string write_scene(int fd, const Scene& scene);

// Reads a scene that write_scene() wrote. The worker is not trusted: a file that is not sealed is refused, and every size is
// checked against the file's size. Indices and numbers are not checked here but by validate(). Returns an empty text on
// success, otherwise the reason.
std::string read_scene(int fd, Scene& scene);

}  // namespace clarity::import
