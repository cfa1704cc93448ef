// Layout: a number that tells a scene, then the arrays of scene_sections.hpp in the order of `visit`.
#include "import/wire.hpp"

#include <type_traits>

#include "base/digest.hpp"
#include "import/scene_sections.hpp"

namespace clarity::import {
namespace {

constexpr uint64_t kMagic = 0x32656E6563536C43;  // "ClScene2"

template <class T>
void give(ParcelWriter& parcel, std::vector<T>& array) {
    static_assert(std::is_trivially_copyable_v<T>, "only plain data goes through shared memory");
    parcel.bytes(array.data(), array.size() * sizeof(T), true);
    std::vector<T>().swap(array);
}

// Elements that others have, too, are copied.
template <class T>
void give(ParcelWriter& parcel, SharedArray<T>& array) {
    if (array.is_sole_owner())
        give(parcel, array.own());
    else
        parcel(array);
    array.clear();
}

Scene scene_in(ParcelReader parcel) {
    SentScene sent;
    parcel(sent);
    parcel.end();
    return std::move(sent.scene);
}

// Leaves out the texts of these elements, which would otherwise leave a trace by their length.
template <class Elements>
void forget_names(Elements& elements) {
    for (auto& element : elements) element.name_bytes = 0;
}

}  // namespace

void SentScene::send(ParcelWriter& parcel, Scene scene) {
    Converted converted = convert(scene);
    parcel(kMagic);
    import::visit(scene, converted, [&](auto& array) { give(parcel, array); });
}  // namespace clarity::import

void SentScene::receive(ParcelReader& parcel, Scene& scene) {
    uint64_t magic = 0;
    parcel(magic);
    if (magic != kMagic) throw Error(Exit::failed, "the shared memory holds no scene");
    Converted converted;
    import::visit(scene, converted, [&](auto& array) { parcel(array); });
    if (!convert_back(converted, scene)) throw ParcelDamaged();
}

void write_scene(MemoryFile& file, Scene scene) {
    ParcelWriter parcel(file);
    SentScene::send(parcel, std::move(scene));
    parcel.finish();
}

Scene read_scene(const MemoryFile& file) {
    return scene_in(ParcelReader(file, ParcelReader::How::emptied));
}

Scene map_scene(const MemoryFile& file) {
    return scene_in(ParcelReader(file, ParcelReader::How::mapped));
}

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
