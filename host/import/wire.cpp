// Layout: a number that tells a scene, then the arrays of scene_sections.hpp in the order of `visit`.
#include "import/wire.hpp"

#include "import/scene_sections.hpp"

namespace clarity::import {
namespace {

constexpr uint64_t kMagic = 0x32656E6563536C43;  // "ClScene2"

template <class T>
void give(PacketWriter& packet, std::vector<T>& array) {
    static_assert(std::is_trivially_copyable_v<T>, "only plain data goes through shared memory");
    packet.bytes(array.data(), array.size() * sizeof(T), true);
    std::vector<T>().swap(array);
}

// Elements that others have, too, are copied.
template <class T>
void give(PacketWriter& packet, SharedArray<T>& array) {
    if (array.is_sole_owner())
        give(packet, array.own());
    else
        packet(array);
    array.clear();
}

Scene scene_in(PacketReader packet) {
    SentScene sent;
    packet(sent);
    packet.end();
    return std::move(sent.scene);
}

}  // namespace

void SentScene::send(PacketWriter& packet, Scene scene) {
    Converted converted = convert(scene);
    packet(kMagic);
    import::visit(scene, converted, [&](auto& array) { give(packet, array);
});
}  // namespace clarity::import

void SentScene::receive(PacketReader& packet, Scene& scene) {
    uint64_t magic = 0;
    packet(magic);
    if (magic != kMagic) throw Error(Exit::failed, "the shared memory holds no scene");
    Converted converted;
    import::visit(scene, converted, [&](auto& array) { packet(array);
});
if (!convert_back(converted, scene)) throw PacketDamaged();
}

void write_scene(MemoryFile& file, Scene scene) {
    PacketWriter packet(file);
    SentScene::send(packet, std::move(scene));
    packet.finish();
}

Scene read_scene(const MemoryFile& file) {
    return scene_in(PacketReader(file, PacketReader::How::emptied));
}

Scene map_scene(const MemoryFile& file) {
    return scene_in(PacketReader(file, PacketReader::How::mapped));
}

}  // namespace clarity::import
