// wire.hpp -- a Scene as one flat file in memory, from the worker process to us.
#pragma once
#include <string>

#include "scene/scene.hpp"

namespace clarity::import {

// Writes the scene into an empty memfd and seals it against any later change. Empty on success, else why not.
std::string write_scene(int fd, const Scene& scene);

// Reads what write_scene wrote, from a worker that nobody trusts: refuses a file that is not sealed, and checks every size
// against the file's own. Indices and numbers are for validate() to judge. Empty on success, else why not.
std::string read_scene(int fd, Scene& scene);

}  // namespace clarity::import
