// import_in_worker.hpp -- runs importers in a process of their own, which may crash, hang or run wild there.
#pragma once
#include "import/import.hpp"

namespace clarity::import {

// As import_scene, whose options it obeys; the scene is as the worker left it, not yet validated.
Scene import_in_worker(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                       Progress& progress);

}  // namespace clarity::import
