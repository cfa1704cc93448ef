// scene_builder.hpp -- reads files into one Scene, in this process: finds the importers, runs them and places their objects.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "import/file_access.hpp"
#include "import/importer_choice.hpp"
#include "import/sink/file_content.hpp"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"
#include "scene/triangulate.hpp"

namespace clarity::import {

// Called before an importer runs, so that the parent process knows which importer and file failed.
class ImportObserver {
 public:
    virtual ~ImportObserver() = default;
    virtual void running(const std::string& file, const std::string& importer) = 0;
    // Before a picture is decoded, which takes that much memory.
    virtual void decoding(uint64_t) {}
};

class SceneBuilder {
 public:
    SceneBuilder(const PluginRegistry& plugins, ImporterParameters parameters, const FileAccess& access, Progress& progress,
                 ImportObserver* observer = nullptr);

    // Adds a file that the user named, with everything that it loads. Throws Error(import_failed) "FILE: why".
    void add_root(const std::string& path);
    // Adds a picture that the user named as a texture of its own. If it cannot be read, that is a warning.
    void add_picture(const std::string& path, rt_u32 space);
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
    void set_info(const std::string& path, const rt_scene_info& info);
    // Takes the sky of the first file that states one. Returns why it cannot; empty: it did, or there is one, or its picture is
    // missing, of which it warns.
    Problem set_sky(const std::string& path, const rt_sky_desc& sky);
    // Loads another file and places it into `into`. Returns nothing on success, otherwise why it failed. Throws
    // Cancelled.
    Problem include(const std::string& from, const std::string& path, const Placement& placement, FileContent& into);
    // Index of the scene's texture for a path, or for a picture in memory; RT_NONE (after a warning) if it cannot be read. A
    // picture is kept once for each colour space, however many textures show it.
    rt_u32 texture_of_file(const std::string& from, const rt_texture_desc& picture);
    rt_u32 texture_of_bytes(const std::string& from, const rt_texture_desc& picture);
    // A number for the next camera or light, by which channels name it until take().
    rt_u32 next_source() { return ++sources_; }

 private:
    struct Opened;
    bool take_faces(const std::string& path, const rt_sky_desc& sky, Sky& into);
    const FileContent& content_of(const std::string& path, const std::string& canonical);
    const FileContent& content_or_sequence(const std::string& path, const std::string& file, const std::string& canonical);
    void place(const std::string& from, const FileContent& content, const Placement& placement, FileContent& into);
    void place_edits(const std::string& from, const FileContent& content, const std::vector<rt_u32>& instances, size_t lights,
                     FileContent& into);
    rt_u32 texture_of(rt_texture picture, const rt_texture_desc& shown);
    void take_motion();
    void subtract_origin();

    const PluginRegistry& plugins_;
    const ImporterParameters parameters_;
    const FileAccess& access_;
    Progress& progress_;
    ImportObserver* observer_;
    Scene scene_;
    FileContent world_;
    Triangulator triangulator_;
    std::map<std::string, std::unique_ptr<FileContent>> files_;  // by canonical path
    // The picture of a canonical path, or of the digest of bytes, and of a colour space; of no width: it cannot be read.
    std::map<std::pair<std::string, rt_u32>, rt_texture> pictures_of_files_, pictures_of_bytes_;
    std::map<std::tuple<rt_u32, rt_u32, rt_u32>, rt_u32> textures_;  // by the picture's first texel, wrap and flags
    std::vector<std::string> open_;  // canonical paths of the files being imported now, outermost first
    uint64_t placed_ = 0;            // number of objects from included files, counted each time they are placed
    size_t warnings_left_out_ = 0;
    rt_u32 sources_ = 0;
    std::vector<bool> as_stored_;  // for each mesh before the file being imported: it is not deformed at rest
    bool stores_ = false;          // those of the file being imported are not
    bool knows_axes_ = false, knows_background_ = false, knows_ambient_ = false;
};

}  // namespace clarity::import
