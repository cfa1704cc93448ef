// import.hpp -- from files to a Scene, through importer plugins in a worker process.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"

namespace clarity::import {

struct ImportOptions {
    bool in_process = false;                // for debugging a plugin; a crash is then ours
    double time_limit_s = 600;              // of CPU time and of wall-clock time without progress
    uint64_t memory_limit_bytes = 0;        // address space of the worker; 0: by the file's size
    std::vector<std::string> search_paths;  // folders besides the file's own that it may read from
    bool log_warnings = true;               // false: the caller shows Scene::warnings itself
    std::string worker;                     // program to run as worker; empty: this one (or CLARITY_WORKER)
};

// Several files become one scene. Throws Error(import_failed) "FILE: why", or Cancelled. The scene is validated.
// Its warnings are in Scene::warnings, and in the log: callers do not log them again.
Scene import_scene(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                   Progress& progress);

// Entry of the worker process (`clarity import-worker ...`, not for people); never returns to the caller's normal path.
int import_worker_main(int argc, char** argv);

}  // namespace clarity::import
