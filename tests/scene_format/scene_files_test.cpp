// The project's own scenes through the built plugins and the worker process, and what a user sees of a broken one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "import/import.hpp"

namespace {

using namespace clarity;

[[maybe_unused]] Scene import_file(const std::string& path) {
    static const PluginRegistry plugins = PluginRegistry::discover();
    Progress progress;
    ImportOptions options;
    if (const char* worker = std::getenv("CLARITY_WORKER")) options.worker = worker;
    return import_scene(plugins, {path}, options, progress);
}

TEST(SceneFiles, FolderIsThere) {
    EXPECT_TRUE(std::filesystem::exists(CLARITY_SOURCE_DIR "/scenes/showpiece.scene"));
}

}  // namespace
