#include "support/scenes.hpp"

#include <cstdlib>
#include <filesystem>
#include <map>

#include "import/import.hpp"

namespace clarity::test {
using namespace import;

std::string source_file(const std::string& name) {
    return std::string(CLARITY_SOURCE_DIR) + "/" + name;
}

std::string shared_file(const std::string& name) {
    const char* folder = std::getenv("CLARITY_SHARED");
    const std::filesystem::path path =
        std::filesystem::path(folder && *folder ? folder : CLARITY_SOURCE_DIR "/../shared") / name;
    return std::filesystem::exists(path) ? path.string() : std::string();
}

ScenePtr load_scene(const std::string& path) {
    static std::map<std::string, ScenePtr> loaded;
    ScenePtr& scene = loaded[path];
    if (!scene) {
        Progress progress;
        scene = std::make_shared<const Scene>(import_scene(Workbench::get().plugins(), {path}, ImportOptions(), progress));
    }
    return scene;
}

ScenePtr geometry_of(const ScenePtr& scene) {
    auto bare = std::make_shared<Scene>(*scene);
    bare->normals.clear();
    bare->uvs.clear();
    bare->textures.clear();
    bare->texels.clear();
    for (Material& material : bare->materials) material.values.texture = RT_NONE;
    return bare;
}

}  // namespace clarity::test
