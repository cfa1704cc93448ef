#include "render/accel/shared_accel.hpp"

#include "base/error.hpp"
#include "base/files/packet.hpp"

namespace clarity {
namespace {

// What of a structure is as it is in memory: all but its plugins, its slots and its leaves.
template <class Packet, class Accel>
void visit_plain(Packet& packet, Accel& a) {
    auto& s = a.scene;
    packet(a.leaf_count, a.bytes, a.build_ms, a.pack_ms, s.bounds.min, s.bounds.max, s.bounds.empty, a.defines, a.stats);
    packet(a.params, a.roots, a.instances);
    packet(s.groups, s.instances, s.group_of_instance, s.world_from_object, s.attribute_triangle, s.flattened);
    packet(s.instance_leaves, s.spheres, s.polygons, s.shape_leaves, s.shapes, s.polygon_table, s.polygon_corners);
    packet(s.planes, s.group_of_mesh, s.first_ref_of_group, s.number_of_instance);
}

AlignedBytes borrow(PacketReader& packet) {
    const uint64_t bytes = packet.begin_array();
    return AlignedBytes::borrow(const_cast<char*>(packet.borrow(bytes)), bytes);
}

const rt_plugin* accel_of(const PluginRegistry& plugins, const std::string& id) {
    if (const rt_plugin* plugin = plugins.accel(id)) return plugin;
    throw Error(Exit::failed,
                "accel " + id + ", which another process has used, is not there; load the same plugins in all processes");
}

}  // namespace

void write_accel(MemoryFile& file, const AccelData& accel) {
    PacketWriter packet(file);
    packet(std::string(accel.plugin->id), std::string(accel.layout->id), uint64_t{accel.slots.size()});
    visit_plain(packet, accel);
    packet.bytes(accel.leaves.data(), accel.leaves.bytes());
    for (const AccelData::Slot& slot : accel.slots) {
        packet(slot.count);
        packet.bytes(slot.memory.data(), slot.memory.bytes());
    }
    packet.finish();
    file.seal();
}

std::shared_ptr<const AccelData> map_accel(const MemoryFile& file, const PluginRegistry& plugins) try {
    struct Mapped {
        std::shared_ptr<const char> memory;  // of slots and leaves
        AccelData accel;
    };
    const auto mapped = std::make_shared<Mapped>();
    AccelData& accel = mapped->accel;
    PacketReader packet(file, PacketReader::How::mapped);
    mapped->memory = packet.memory();
    std::string plugin, layout;
    uint64_t slots = 0;
    packet(plugin, layout, slots);
    accel.plugin = accel_of(plugins, plugin);
    accel.layout = accel_of(plugins, layout);
    visit_plain(packet, accel);
    accel.leaves = borrow(packet);
    for (uint64_t s = 0; s < slots; ++s) {
        uint64_t count = 0;
        packet(count);
        accel.slots.push_back({borrow(packet), count});
    }
    packet.end();
    return {mapped, &accel};
} catch (const PacketDamaged&) {
    throw Error(Exit::failed, "the shared memory holds no structure of this program: do all processes run the same version?");
}

}  // namespace clarity
