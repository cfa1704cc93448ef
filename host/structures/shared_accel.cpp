#include "structures/shared_accel.hpp"

#include "base/error.hpp"
#include "base/files/parcel.hpp"

namespace clarity {
namespace {

const rt_plugin* accel_of(const PluginRegistry& plugins, const std::string& id) {
    if (const rt_plugin* plugin = plugins.accel(id)) return plugin;
    throw Error(Exit::failed,
                "accel " + id + ", which another process has used, is not there; load the same plugins in all processes");
}

// Members one after the other: plugins by their ids, memory as it is. The reader borrows the latter of the parcel.
template <class How, class T>
void transfer(const How& how, T& value);
struct Write {
    ParcelWriter& parcel;
    void operator()(const rt_plugin* plugin) const { parcel(std::string(plugin->id)); }
    void operator()(const AlignedBytes& memory) const { parcel.bytes(memory.data(), memory.bytes()); }
    void operator()(const std::vector<AccelData::Slot>& slots) const {
        parcel(uint64_t{slots.size()});
        for (const AccelData::Slot& slot : slots) transfer(*this, slot);
    }
};
struct Read {
    ParcelReader& parcel;
    const PluginRegistry& plugins;
    void operator()(const rt_plugin*& plugin) const {
        std::string id;
        parcel(id);
        plugin = accel_of(plugins, id);
    }
    void operator()(AlignedBytes& memory) const {
        const uint64_t bytes = parcel.begin_array();
        memory = AlignedBytes::borrow(const_cast<char*>(parcel.borrow(bytes)), bytes);
    }
    void operator()(std::vector<AccelData::Slot>& slots) const {
        uint64_t count = 0;
        for (parcel(count); count > 0; --count) transfer(*this, slots.emplace_back());
    }
};
template <class How, class T>
void transfer(const How& how, T& value) {
    if constexpr (has_members<T>)
        for_each_member(value, [&](auto& member) { transfer(how, member); });
    else if constexpr (std::is_invocable_v<const How&, T&>)
        how(value);
    else
        how.parcel(value);
}

}  // namespace

void write_accel(MemoryFile& file, const AccelData& accel) {
    ParcelWriter parcel(file);
    transfer(Write{parcel}, accel);
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
    transfer(Read{parcel, plugins}, accel);
    parcel.end();
    return {mapped, &accel};
} catch (const ParcelDamaged&) {
    throw Error(Exit::failed, "the shared memory holds no structure of this program: do all processes run the same version?");
}

}  // namespace clarity
