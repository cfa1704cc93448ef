// scene_catalog.hpp -- finds the scenes which suites name.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "import/import.hpp"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"
#include "view/view.hpp"

namespace clarity::bench {

struct BenchScene {
    std::string name;
    std::vector<std::string> files;  // imported together as one scene; .gz files are unpacked first
    std::string camera, light;       // in the syntax of make_view; "": the scene's own
    std::string computed;            // a name of zoo_scenes.hpp: what is added to the files, of which there may be none
    uint64_t triangles = 0;          // of what is computed, about
    std::string shape;               // a name of zoo_scenes.hpp: that mesh is added
    unsigned parts = 0;              // of the mesh
    std::string missing;             // not empty: the scene was not found; where it was sought, and what to do
};

// A scene seen from a chosen camera.
struct BenchView {
    BenchScene scene;
    uint64_t subdivide_to = 0;  // split to about so many triangles; 0: unchanged
};

// Finds the scenes of the project and larger shared scenes.
//   project  $CLARITY_SCENES; if it is not set, ../share/clarity/scenes relative to the executable (a build folder has a link
//            there)
//   shared   $CLARITY_SHARED; its bench/cameras.json names models and cameras
class SceneCatalog {
 public:
    SceneCatalog();
    SceneCatalog(std::string project_folder, std::string shared_folder);  // for tests

    // A .scene or model file of the project by its path without extension, "thesis/1_two_triangles". If there is none,
    // `missing` says so.
    BenchScene project(const std::string& name) const;
    // The six test scenes of scenes/thesis in order.
    std::vector<BenchScene> thesis() const;
    // The scenes of cameras.json, small files first. If there is no such file, one entry with a `missing` that says so.
    std::vector<BenchScene> shared() const;
    // Models of the project and of the shared folder from near (one triangle covers many pixels) and from far (one pixel covers
    // several triangles). The `missing` of an entry says that its file was not found.
    std::vector<BenchView> views() const;
    // Eight scenes that are hard in different ways: five that are computed, of about so many triangles, and three scans.
    std::vector<BenchScene> zoo(uint64_t triangles) const;
    // Each kind of zoo_scenes.hpp: the shape, "torus", and its meshes, "torus, 32 parts".
    std::vector<BenchScene> shapes() const;

 private:
    std::string project_, shared_;
};

// A scene of a file named by the user: its name is the file's stem, its camera is its own.
BenchScene scene_of_file(const std::string& path);

struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    View view;
    double import_ms = 0;
};
// Imports a scene and sets camera and light. Throws Error(import_failed), Error(usage) if the scene lacks the named camera, and
// Cancelled.
LoadedScene load_scene(const PluginRegistry& plugins, const BenchScene& scene, float aspect,
                       const import::ImportOptions& options, Progress& progress);

}  // namespace clarity::bench
