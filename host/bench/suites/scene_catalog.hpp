// scene_catalog.hpp -- the scenes that suites name, and where they are found.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "import/import.hpp"
#include "render/frame/renderer.hpp"

namespace clarity::bench {

struct BenchScene {
    std::string name;
    std::vector<std::string> files;  // become one scene; .gz is unpacked first
    std::string camera, light;       // as make_view reads them; "": the scene's own
    std::string missing;             // not empty: it was not found, and this says where it was looked for and what to do
};

// A scene seen from a chosen place.
struct BenchView {
    BenchScene scene;
    uint64_t subdivide_to = 0;  // about so many triangles; 0: as it is
};

// Finds scenes of the project and larger shared ones.
//   project  $CLARITY_SCENES, else ../share/clarity/scenes relative to the executable (a build folder has a link there)
//   shared   $CLARITY_SHARED, with bench/cameras.json that names models and cameras
class SceneCatalog {
 public:
    SceneCatalog();
    SceneCatalog(std::string project_folder, std::string shared_folder);  // for tests

    // "thesis/1_two_triangles": a .scene or model file of the project, by its path without extension.
    BenchScene project(const std::string& name) const;
    // The six of scenes/thesis and the 21 spheres, in order.
    std::vector<BenchScene> thesis() const;
    // Those of cameras.json; one entry that says so if there is none.
    std::vector<BenchScene> shared() const;
    // Models of the project and the shared folder from close by, where a triangle covers many pixels, and from afar, where
    // several share one; what is not found says so.
    std::vector<BenchView> views() const;

 private:
    std::string project_, shared_;
};

// A scene that a person named: file stem, its own camera.
BenchScene scene_of_file(const std::string& path);

struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    View view;
    double import_ms = 0;
};
// Throws Error(import_failed), Error(usage) for a camera that is not there, Cancelled.
LoadedScene load_scene(const PluginRegistry& plugins, const BenchScene& scene, float aspect,
                       const import::ImportOptions& options, Progress& progress);

}  // namespace clarity::bench
