// scene_builder.hpp -- reads files into one Scene, in this process: finds the importers, runs them and places their objects.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "import/file_access.hpp"
#include "import/importer_choice.hpp"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"
#include "scene/triangulate.hpp"

namespace clarity::import {

// The objects that one file places in its own space. Meshes, materials and textures are in the Scene already, and only once,
// however often the file is placed.
struct FileContent {
    struct PolygonCorners {
        std::vector<float> corners;  // 3 each
        rt_u32 material = 0;
    };
    std::vector<Instance> instances;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<PolygonCorners> polygons;
    std::vector<Shape> shapes;
    // included: those of files that this file loads. They are kept apart so that the first camera is the file's own.
    std::vector<Light> lights, included_lights;
    std::vector<Camera> cameras, included_cameras;
};

// How a file is placed in another file.
struct Placement {
    std::string name;  // name of the instance; if the file has several, the first part of their names
    Affine world_from_object = kIdentity;
    rt_u32 material = RT_NONE;  // scene material for all of it; RT_NONE: the file's own materials
};

// Called before an importer runs, so that the parent process knows which importer and file failed.
class ImportObserver {
 public:
    virtual ~ImportObserver() = default;
    virtual void running(const std::string& file, const std::string& importer) = 0;
};

class SceneBuilder {
 public:
    SceneBuilder(const PluginRegistry& plugins, ImporterParameters parameters, const FileAccess& access, Progress& progress,
                 ImportObserver* observer = nullptr);

    // Adds a file that the user named, with everything that it loads. Throws Error(import_failed) "FILE: why".
    void add_root(const std::string& path);
    // Returns the finished scene. It is sound, but callers still check it with validate(), as a safeguard against bugs here.
    Scene take();

    // ---- for SceneSink
    Scene& scene() { return scene_; }
    Triangulator& triangulator() { return triangulator_; }
    const PluginRegistry& plugins() const { return plugins_; }
    Progress& progress() { return progress_; }
    // Number of a kind of shapes in the scene, which it gets on first use.
    rt_u32 shape_kind(const std::string& id);
    const FileAccess& access() const { return access_; }
    void warn(const std::string& file, const std::string& text);
    // Background, axes and units come from the first file that states them.
    void set_info(const rt_scene_info& info);
    // Loads another file and places it into `into`. Returns an empty text on success, otherwise why it failed. Throws
    // Cancelled.
    std::string include(const std::string& from, const std::string& path, const Placement& placement, FileContent& into);
    // Index of the scene's texture for a path; RT_NONE (after a warning) if it cannot be read.
    rt_u32 texture_of_file(const std::string& from, const std::string& path);

 private:
    const FileContent& content_of(const std::string& path, const std::string& canonical);
    void place(const std::string& from, const FileContent& content, const Placement& placement, FileContent& into);
    void bake_flattened_instances();

    const PluginRegistry& plugins_;
    const ImporterParameters parameters_;
    const FileAccess& access_;
    Progress& progress_;
    ImportObserver* observer_;
    Scene scene_;
    FileContent world_;
    Triangulator triangulator_;
    std::map<std::string, std::unique_ptr<FileContent>> files_;  // by canonical path
    std::map<std::string, rt_u32> textures_;                     // by canonical path
    std::vector<std::string> open_;  // canonical paths of the files being imported now, outermost first
    uint64_t placed_ = 0;            // number of objects from included files, counted each time they are placed
    size_t warnings_left_out_ = 0;
    bool knows_axes_ = false, knows_background_ = false, knows_ambient_ = false;
};

}  // namespace clarity::import
