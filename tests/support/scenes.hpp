// scenes.hpp -- scenes from files: the project's own, and the larger shared ones if they are there.
#pragma once
#include <string>

#include "support/workbench.hpp"

namespace clarity::test {

// Path of a file of this checkout, given its path inside it.
std::string source_file(const std::string& name);
// Path of a file of the shared models (folder CLARITY_SHARED, else ../shared beside the checkout). Empty if it is missing.
std::string shared_file(const std::string& name);

// Imports a scene, once in each process. Throws what import_scene() throws.
ScenePtr load_scene(const std::string& path);

// A copy without normals, texture coordinates and textures. Scenes from different sources then need the same kernel, which is
// compiled once.
ScenePtr geometry_of(const ScenePtr& scene);

// Skips the test with a message if a shared model is missing.
#define CLARITY_SHARED_OR_SKIP(path, name)                       \
    const std::string path = ::clarity::test::shared_file(name); \
    if (path.empty()) GTEST_SKIP() << "SKIPPED: no shared model " << (name) << "; CLARITY_SHARED names their folder"

}  // namespace clarity::test
