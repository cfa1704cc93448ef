#include "images/path_scenes.hpp"

#include <filesystem>
#include <memory>
#include <regex>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

namespace clarity::test {
namespace {

// A scene file made of a shared one by replacing parts of its text.
ScenePtr changed_scene(const std::string& file, const std::string& before,
                       const std::vector<std::pair<const char*, const char*>>& changes, const std::string& sky = "") {
    const std::string path = shared_file(file);
    if (path.empty()) return nullptr;
    std::string text = read_file(path, 1u << 20, Exit::failed);
    for (const auto& [from, to] : changes) text = std::regex_replace(text, std::regex(from), to);
    const Scratch folder;
    if (!sky.empty()) std::filesystem::copy_file(shared_file(sky), folder.path("sky.exr"));
    return load_scene(folder.write("a.scene", before + text));
}

}  // namespace

ScenePtr cornell_box() {
    return changed_scene("light/scenes/cornell_light.scene", "",
                         {{"specular 0 0 0", "model lambert"}, {"emission", "one_sided true emission"}});
}

ScenePtr spheres_under_sky() {
    return changed_scene("light/scenes/spheres_light.scene", "sky \"sky.exr\"\n",
                         {{"metal_(.)(..) color 1 1 1 reflect 1", "metal_$1$2 model conductor color 1 roughness $1.$2"},
                          {"color 1 1 1 reflect 1", "model conductor color 1"},
                          {"refract 1", "model dielectric"},
                          {"(color [.\\d]+ [.\\d]+ [.\\d]+) specular", "model lambert $1 specular"}},
                         "light/scenes/env.exr");
}

ScenePtr bathroom_under_sky() {
    const std::string one = shared_file("scenes/models/salle_de_bain_part1.ply.gz"),
                      two = shared_file("scenes/models/salle_de_bain_part2.ply.gz"), sky = shared_file("light/scenes/env.exr");
    if (one.empty() || two.empty() || sky.empty()) return nullptr;
    const Scratch folder;
    std::filesystem::copy_file(one, folder.path("one.ply.gz"));
    std::filesystem::copy_file(two, folder.path("two.ply.gz"));
    std::filesystem::copy_file(sky, folder.path("sky.exr"));
    return load_scene(folder.write("a.scene",
                                   "sky sky.exr\ncamera main eye 4.4432 16.9344 49.91 target -1.28 11.27 .56 fov 36\n"
                                   "material tiles model lambert color .6\n"
                                   "load one.ply.gz material tiles\nload two.ply.gz material tiles\n"));
}

ScenePtr veach_plates() {
    return load_scene(source_file("scenes/veach.scene"));
}

ScenePtr showpiece_under_sky() {
    const ScenePtr lit = spheres_under_sky();
    if (!lit) return nullptr;
    Scene scene = *load_scene(source_file("scenes/showpiece.scene"));
    scene.sky = lit->sky;
    return std::make_shared<const Scene>(std::move(scene));
}

}  // namespace clarity::test
