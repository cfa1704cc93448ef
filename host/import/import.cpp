#include "import/import.hpp"

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/log.hpp"
#include "base/timeline.hpp"
#include "import/file_access.hpp"
#include "import/import_in_worker.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/sink/world_origin.hpp"

namespace clarity::import {
namespace {

Scene import_in_process(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                        Progress& progress) {
    const FileAccess access(files, options.search_paths, options.pictures);
    SceneBuilder builder(plugins, parse_importer_choices(plugins, options.importers), access, progress);
    for (const std::string& file : files) builder.add_root(file);
    for (const PictureFile& picture : options.pictures) builder.add_picture(picture.path, picture.space);
    return builder.take();
}

}  // namespace

Problem complete_scene(const PluginRegistry& plugins, Scene& scene) {
    for (ShapeKind& kind : scene.shape_kinds) {
        kind.plugin = plugins.primitive(kind.id);
        if (!kind.plugin) return "has shapes of the unknown kind " + kind.id;
    }
    if (const Problem why = validate(scene)) return "is not sound: " + why.text();
    note_used_materials(scene);
    return {};
}

Scene import_scene(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                   Progress& progress) {
    if (files.empty()) throw Error(Exit::usage, "no scene file given");
    for (const std::string& file : files) {
        const std::string first = first_frame(file);
        if (first.empty())
            throw Error(Exit::import_failed, file + ": no file has such a name; # stands for the digits of a frame's number");
        check_model_file(first);
    }
    const timeline::Scope span("import", [&] { return "import " + files.front(); });
    Scene scene = options.in_process ? import_in_process(plugins, files, options, progress)
                                     : import_in_worker(plugins, files, options, progress);
    if (const Problem why = complete_scene(plugins, scene))
        throw Error(Exit::import_failed, files.front() + ": the imported scene " + why.text());
    for (const std::string& warning : scene.warnings)
        if (options.log_warnings) log(LogLevel::warning, warning);
    return scene;
}

SequenceReader::SequenceReader(const PluginRegistry& plugins, ImportOptions options, Progress& progress)
    : plugins_(plugins), options_(std::move(options)), progress_(progress) {
    options_.log_warnings = false;  // the first file of the sequence has said them
}

std::vector<float> SequenceReader::operator()(const std::string& file) {
    for (const auto& [known, positions] : kept_)
        if (known == file) return positions;
    constexpr size_t kMostKept = 2;
    while (kept_.size() >= kMostKept) kept_.pop_front();
    Scene scene = import_scene(plugins_, {file}, options_, progress_);
    // Back to the file's coordinates, which all files of a sequence share.
    for (const Instance& instance : scene.instances) {
        if (scene.origin == std::array<double, 3>{}) break;
        add_origin(scene, instance, scene.origin);
    }
    kept_.emplace_back(file, std::move(scene.positions.own()));
    return kept_.back().second;
}

}  // namespace clarity::import
