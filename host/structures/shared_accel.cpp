#include "structures/shared_accel.hpp"

#include "base/error.hpp"
#include "base/files/parcel.hpp"

namespace clarity {
namespace {

// What of a structure is as it is in memory: all but its plugins, its slots and its leaves.
template <class Parcel, class Accel>
void visit_plain(Parcel& parcel, Accel& a) {
    auto& s = a.scene;
    parcel(a.leaf_count, a.bytes, a.build_ms, a.pack_ms, s.bounds.min, s.bounds.max, s.bounds.empty, s.object_bounds.min,
           s.object_bounds.max, s.object_bounds.empty, a.defines, a.stats);
    parcel(a.params, a.roots, a.instances);
    parcel(s.groups, s.instances, s.group_of_instance, s.world_from_object, s.attribute_triangle, s.flattened);
    parcel(s.instance_leaves, s.spheres, s.polygons, s.shape_leaves, s.shapes, s.polygon_table, s.polygon_corners);
    parcel(s.planes, s.group_of_mesh, s.first_ref_of_group, s.number_of_instance);
}

AlignedBytes borrow(ParcelReader& parcel) {
    const uint64_t bytes = parcel.begin_array();
    return AlignedBytes::borrow(const_cast<char*>(parcel.borrow(bytes)), bytes);
}

const rt_plugin* accel_of(const PluginRegistry& plugins, const std::string& id) {
    if (const rt_plugin* plugin = plugins.accel(id)) return plugin;
    throw Error(Exit::failed,
                "accel " + id + ", which another process has used, is not there; load the same plugins in all processes");
}

}  // namespace

void write_accel(MemoryFile& file, const AccelData& accel) {
    ParcelWriter parcel(file);
    parcel(std::string(accel.plugin->id), std::string(accel.layout->id), uint64_t{accel.slots.size()});
    visit_plain(parcel, accel);
    parcel.bytes(accel.leaves.data(), accel.leaves.bytes());
    for (const AccelData::Slot& slot : accel.slots) {
        parcel(slot.count);
        parcel.bytes(slot.memory.data(), slot.memory.bytes());
    }
    parcel.finish();
    file.seal();
}

std::shared_ptr<const AccelData> map_accel(const MemoryFile& file, const PluginRegistry& plugins) try {
    struct Mapped {
        std::shared_ptr<const char> memory;  // of slots and leaves
        AccelData accel;
    };
    const auto mapped = std::make_shared<Mapped>();
    AccelData& accel = mapped->accel;
    ParcelReader parcel(file, ParcelReader::How::mapped);
    mapped->memory = parcel.memory();
    std::string plugin, layout;
    uint64_t slots = 0;
    parcel(plugin, layout, slots);
    accel.plugin = accel_of(plugins, plugin);
    accel.layout = accel_of(plugins, layout);
    visit_plain(parcel, accel);
    accel.leaves = borrow(parcel);
    for (uint64_t s = 0; s < slots; ++s) {
        uint64_t count = 0;
        parcel(count);
        accel.slots.push_back({borrow(parcel), count});
    }
    parcel.end();
    return {mapped, &accel};
} catch (const ParcelDamaged&) {
    throw Error(Exit::failed, "the shared memory holds no structure of this program: do all processes run the same version?");
}

}  // namespace clarity
