#include "import/scene_digest.hpp"

#include <type_traits>

#include "base/digest.hpp"
#include "import/scene_sections.hpp"

namespace clarity::import {
namespace {

// Leaves out the texts of these elements, which would otherwise leave a trace by their length.
template <class Elements>
void forget_names(Elements& elements) {
    for (auto& element : elements) element.name_bytes = 0;
}

}  // namespace

std::string scene_digest(const Scene& scene) {
    Converted converted = convert(scene);
    forget_names(converted.meshes), forget_names(converted.instances), forget_names(converted.materials);
    forget_names(converted.lights), forget_names(converted.nodes), forget_names(converted.morphs);
    forget_names(converted.sequences);
    for (WireNode& node : converted.nodes) node.values.name = nullptr;
    converted.globals.front().sky_file_bytes = 0;
    converted.warnings.clear(), converted.edits.clear(), converted.sources.clear(), converted.names.clear();
    converted.texture_names.clear();
    Digest digest;
    visit(scene, converted, [&](const auto& array) {
        using Element = typename std::decay_t<decltype(array)>::value_type;
        digest.add_value(uint64_t(array.size()));
        digest.add_bytes(array.data(), array.size() * sizeof(Element));
    });
    // Users choose cameras and clips by their names; the id of a shape says which kernel intersects it.
    for (const ShapeKind& kind : scene.shape_kinds) digest.add(kind.id);
    for (const Camera& camera : scene.cameras) digest.add(camera.name);
    for (const Clip& clip : scene.motion.clips) digest.add(clip.name);
    for (const SceneEdit& edit : scene.edits) digest.add(edit.key), digest.add(edit.value);
    return digest.hex();
}

}  // namespace clarity::import
