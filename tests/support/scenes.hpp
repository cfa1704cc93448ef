// scenes.hpp -- scenes from files: the project's own, and the larger shared ones where they are.
#pragma once
#include <string>

#include "support/workbench.hpp"

namespace clarity::test {

// A file of this checkout, by its path in it.
std::string source_file(const std::string& name);
// A file of the shared models (CLARITY_SHARED, else ../shared beside the checkout); empty if it is not there.
std::string shared_file(const std::string& name);

// Imported once in a process. Throws what import_scene throws.
ScenePtr load_scene(const std::string& path);

// What rays can meet and nothing else: without normals, texture coordinates and textures, scenes of different make need the
// same kernel, which is then compiled once.
ScenePtr geometry_of(const ScenePtr& scene);

// For tests that need a shared model: skips the test, and says so, where it is missing.
#define CLARITY_SHARED_OR_SKIP(path, name)                       \
    const std::string path = ::clarity::test::shared_file(name); \
    if (path.empty()) GTEST_SKIP() << "SKIPPED: no shared model " << (name) << "; CLARITY_SHARED names their folder"

}  // namespace clarity::test
