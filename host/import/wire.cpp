// Layout: a number that tells a scene, then its members in the order of their lists.
#include "import/wire.hpp"

#include <type_traits>

#include "base/digest.hpp"

namespace clarity::import {
namespace {

constexpr uint64_t kMagic = 0x33656E6563536C43;  // "ClScene3"

// Writes a value, which is empty afterwards. Memory that it does not share goes back to the system behind the writing.
template <class T>
void give(ParcelWriter& parcel, T& value) {
    if constexpr (has_members<T>) {
        for_each_member(value, [&](auto& member) { give(parcel, member); });
    } else if constexpr (detail::is_shared<T>) {
        if (value.is_sole_owner())
            give(parcel, value.own());
        else
            parcel(value);
    } else if constexpr (detail::is_array<T> && !std::is_trivially_copyable_v<T> && !std::is_same_v<T, std::string>) {
        parcel.bytes(value.data(), value.size() * sizeof value[0], true);
    } else {
        parcel(value);
    }
    if constexpr (!has_members<T>) value = T();
}

// A parcel of which only a digest is kept, without the texts in it.
class DigestParcel {
 public:
    static constexpr bool kWrites = true;
    template <class... Values>
    void operator()(const Values&... values) {
        (add(values), ...);
    }
    Digest digest;

 private:
    template <class T>
    void add(const T& value) {
        if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<std::string>>) {
            return;
        } else if constexpr (detail::is_visited<T, DigestParcel>) {
            T::visit(*this, value);
        } else if constexpr (has_members<T>) {
            for_each_member(value, [this](const auto& member) { add(member); });
        } else if constexpr (std::is_trivially_copyable_v<T>) {
            digest.add_bytes(&value, sizeof value);
        } else {
            digest.add_value(uint64_t{value.size()});
            if constexpr (detail::is_array<T>)
                digest.add_bytes(value.data(), value.size() * sizeof *value.data());
            else
                for (const auto& element : value) add(element);
        }
    }
};

Scene scene_in(ParcelReader parcel) {
    SentScene sent;
    parcel(sent);
    parcel.end();
    return std::move(sent.scene);
}

}  // namespace

void SentScene::send(ParcelWriter& parcel, Scene scene) {
    parcel(kMagic);
    give(parcel, scene);
}

void SentScene::receive(ParcelReader& parcel, Scene& scene) {
    uint64_t magic = 0;
    parcel(magic);
    if (magic != kMagic) throw Error(Exit::failed, "the shared memory holds no scene");
    parcel(scene);
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
    DigestParcel parcel;
    parcel(scene);
    Digest& digest = parcel.digest;
    // Users choose cameras and clips by their names; the id of a shape says which kernel intersects it.
    for (const ShapeKind& kind : scene.shape_kinds) digest.add(kind.id);
    for (const Camera& camera : scene.cameras) digest.add(camera.name);
    for (const Clip& clip : scene.motion.clips) digest.add(clip.name);
    for (const SceneEdit& edit : scene.edits) digest.add(edit.key), digest.add(edit.value);
    return digest.hex();
}

}  // namespace clarity::import
