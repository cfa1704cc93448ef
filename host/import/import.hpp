// import.hpp -- reads files into a Scene. Importer plugins run in a worker process.
#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "plugin/registry.hpp"
#include "scene/map_edit.hpp"
#include "scene/scene.hpp"

namespace clarity::import {

struct ImportOptions {
    bool in_process = false;                // for debugging a plugin; a crash then ends this program
    double time_limit_s = 600;              // seconds of CPU time, and of wall-clock time without progress
    uint64_t memory_limit_bytes = 0;        // of the worker's address space; 0: chosen by the file's size
    std::vector<std::string> search_paths;  // folders that it may read from, besides the folder of each file
    std::vector<std::string> importers;     // "ID,key=value...": parameters of importers; see importer_choice.hpp
    std::vector<PictureFile> pictures;      // become textures behind those of the files; their names are whole paths
    bool log_warnings = true;               // false: the caller shows Scene::warnings itself
    std::string worker;                     // program that runs as the worker; empty: CLARITY_WORKER, or this program
};

// Reads several files into one scene. The result is validated. Warnings are in Scene::warnings and also in the log (see
// log_warnings), so callers do not log them again. Throws Error(import_failed) "FILE: why", or Cancelled.
Scene import_scene(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                   Progress& progress);

// Finds the plugins of the shapes in a scene that has come as plain arrays, and validates it. Returns nothing on success,
// otherwise what the scene has or is ("is not sound: ...").
Problem complete_scene(const PluginRegistry& plugins, Scene& scene);

// Reads the files of sequences when poses need them, and keeps the last two.

// Not thread-safe.
class SequenceReader {
 public:
    SequenceReader(const PluginRegistry& plugins, ImportOptions options, Progress& progress);
    // The vertices of a file, as FrameVertices of scene/motion/pose.hpp asks for them. Throws what import_scene() throws.
    std::vector<float> operator()(const std::string& file);

 private:
    const PluginRegistry& plugins_;
    ImportOptions options_;
    Progress& progress_;
    std::deque<std::pair<std::string, std::vector<float>>> kept_;
};

}  // namespace clarity::import
