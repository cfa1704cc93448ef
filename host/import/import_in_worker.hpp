// import_in_worker.hpp -- runs importers in a process of their own, so that a crash or a hang does not harm this one.
#pragma once
#include "import/import.hpp"
#include "worker/job.hpp"

namespace clarity::import {

// Same as import_scene(), with the same options. The scene is returned as the worker sent it and is not validated.
Scene import_in_worker(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                       Progress& progress);

extern const worker::JobKind kImportJob;

}  // namespace clarity::import
