// scene_builder.hpp -- from files to one Scene, in this process: finds importers, runs them, places what they bring.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "import/file_access.hpp"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"
#include "scene/triangulate.hpp"

namespace clarity::import {

// What one file places in its own space. Meshes, materials and textures are in the Scene already, once, however often the file
// is placed.
struct FileContent {
    struct PolygonCorners {
        std::vector<float> corners;  // 3 each
        rt_u32 material = 0;
    };
    std::vector<Instance> instances;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<PolygonCorners> polygons;
    std::vector<Light> lights, included_lights;     // included: of files that this one loads, so that
    std::vector<Camera> cameras, included_cameras;  // the first camera is the file's own
};

// How a file is placed into another one.
struct Placement {
    std::string name;  // of the instance; or the first part of the names, if the file brings several
    Affine world_from_object = kIdentity;
    rt_u32 material = RT_NONE;  // a scene material, for all of it
};

// Told before an importer runs: whoever watches from outside knows what to blame.
class ImportObserver {
 public:
    virtual ~ImportObserver() = default;
    virtual void running(const std::string& file, const std::string& importer) = 0;
};

class SceneBuilder {
 public:
    SceneBuilder(const PluginRegistry& plugins, const FileAccess& access, Progress& progress,
                 ImportObserver* observer = nullptr);

    // Adds a file that the user named. Throws Error(import_failed) "FILE: why".
    void add_root(const std::string& path);
    // The finished scene; sound unless there is a bug here, which callers still check with validate().
    Scene take();

    // ---- for SceneSink
    Scene& scene() { return scene_; }
    Triangulator& triangulator() { return triangulator_; }
    const FileAccess& access() const { return access_; }
    void warn(const std::string& file, const std::string& text);
    // Background, axes and units are those of the first file that the user named and that says them.
    void set_info(const rt_scene_info& info);
    // Loads another file into `into`; empty on success, else why not. Throws Cancelled.
    std::string include(const std::string& from, const std::string& path, const Placement& placement, FileContent& into);
    // A scene-wide texture of a path, RT_NONE (after a warning) if there is none.
    rt_u32 texture_of_file(const std::string& from, const std::string& path);

 private:
    const FileContent& content_of(const std::string& path, const std::string& canonical);
    void place(const std::string& from, const FileContent& content, const Placement& placement, FileContent& into);
    void bake_flattened_instances();

    const PluginRegistry& plugins_;
    const FileAccess& access_;
    Progress& progress_;
    ImportObserver* observer_;
    Scene scene_;
    FileContent world_;
    Triangulator triangulator_;
    std::map<std::string, std::unique_ptr<FileContent>> files_;  // by canonical path
    std::map<std::string, rt_u32> textures_;                     // by canonical path
    std::vector<std::string> open_;                              // canonical paths being imported, outermost first
    uint64_t placed_ = 0;                                        // objects of included files, each time that they are placed
    size_t warnings_left_out_ = 0;
    bool knows_axes_ = false, knows_background_ = false, knows_ambient_ = false;
};

}  // namespace clarity::import
