// Layout: arrays one behind the other, in the order of write_accel() and visit_scene(). Each begins at a multiple of 128 bytes,
// as the buffers of devices do, with the number of its bytes in the 128 bytes before it.
#include "render/accel/shared_accel.hpp"

#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr uint64_t kAlignment = 128;

// The members that are no arrays. They are written as an array of one element.
struct PlainMembers {
    uint64_t leaf_count, bytes;
    double build_ms, pack_ms;
    std::array<float, 3> min, max;
    uint32_t slot_count, empty_bounds;
};

// Names with numbers, as arrays.
template <class Number>
struct Named {
    std::string names;  // each ends with a zero byte
    std::vector<Number> numbers;
    template <class Pairs>
    static Named of(const Pairs& pairs) {
        Named named;
        for (const auto& [name, number] : pairs)
            named.names.append(name.c_str(), name.size() + 1), named.numbers.push_back(number);
        return named;
    }
    // call(name, number) for each.
    template <class Call>
    void each(const Call& call) const {
        size_t at = 0;
        for (const Number& number : numbers) {
            const std::string name = names.c_str() + at;
            call(name, number);
            at = std::min(names.size(), at + name.size() + 1);
        }
    }
};

// All arrays but slots and leaves.
template <class Archive, class Accel, class Scene>
void visit_scene(Archive&& a, Accel& accel, Scene& s) {
    a(accel.params), a(accel.roots), a(accel.instances);
    a(s.groups), a(s.instances), a(s.group_of_instance), a(s.world_from_object), a(s.attribute_triangle), a(s.flattened);
    a(s.instance_leaves), a(s.spheres), a(s.polygons), a(s.shape_leaves), a(s.shapes), a(s.polygon_table), a(s.polygon_corners);
    a(s.planes), a(s.group_of_mesh), a(s.first_ref_of_group), a(s.number_of_instance);
}

class AccelWriter {
 public:
    explicit AccelWriter(MemoryFile& file) : file_(file) {}
    template <class Array>
    void operator()(const Array& array) {
        static_assert(std::is_trivially_copyable_v<typename Array::value_type>, "only plain data goes through shared memory");
        bytes(array.data(), array.size() * sizeof(typename Array::value_type));
    }
    void bytes(const void* data, uint64_t count) {
        file_.write_at(at_, &count, sizeof count);
        at_ += kAlignment;
        file_.write_at(at_, data, count);
        at_ += (count + kAlignment - 1) / kAlignment * kAlignment;
    }
    // Makes the file as long as the last array is with its padding: kernels read whole vectors.
    void end() {
        if (at_ > file_.bytes()) file_.write_at(at_ - 1, "", 1);
        file_.seal();
    }

 private:
    MemoryFile& file_;
    uint64_t at_ = 0;
};

class AccelReader {
 public:
    AccelReader(const char* data, uint64_t bytes) : data_(data), left_(bytes) {}
    template <class Array>
    void operator()(Array& array) {
        using Element = typename Array::value_type;
        const auto [data, bytes] = next();
        const auto* first = reinterpret_cast<const Element*>(data);
        array.assign(first, first + bytes / sizeof(Element));
    }
    AlignedBytes borrow() {
        const auto [data, bytes] = next();
        return AlignedBytes::borrow(const_cast<char*>(data), bytes);
    }

 private:
    std::pair<const char*, uint64_t> next() {
        uint64_t bytes = 0;
        if (left_ >= kAlignment) std::memcpy(&bytes, data_, sizeof bytes);
        if (left_ < kAlignment || bytes > left_ - kAlignment)
            throw Error(Exit::failed,
                        "the shared memory holds no structure of this program: do all processes run the same version?");
        const char* const here = data_ + kAlignment;
        const uint64_t step = kAlignment + std::min(left_ - kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment);
        data_ += step, left_ -= step;
        return {here, bytes};
    }
    const char* data_;
    uint64_t left_;
};

const rt_plugin* accel_of(const PluginRegistry& plugins, const std::string& id) {
    if (const rt_plugin* plugin = plugins.accel(id)) return plugin;
    throw Error(Exit::failed,
                "accel " + id + ", which another process has used, is not there; load the same plugins in all processes");
}

}  // namespace

void write_accel(MemoryFile& file, const AccelData& accel) {
    AccelWriter writer(file);
    writer(std::string(accel.plugin->id)), writer(std::string(accel.layout->id));
    writer(std::vector<PlainMembers>{{accel.leaf_count, accel.bytes, accel.build_ms, accel.pack_ms, accel.scene.bounds.min,
                                      accel.scene.bounds.max, static_cast<uint32_t>(accel.slots.size()),
                                      accel.scene.bounds.empty}});
    const auto defines = Named<rt_u32>::of(accel.defines);
    const auto stats = Named<double>::of(accel.stats);
    writer(defines.names), writer(defines.numbers), writer(stats.names), writer(stats.numbers);
    visit_scene(writer, accel, accel.scene);
    writer.bytes(accel.leaves.data(), accel.leaves.bytes());
    for (const AccelData::Slot& slot : accel.slots) {
        writer(std::vector<uint64_t>{slot.count});
        writer.bytes(slot.memory.data(), slot.memory.bytes());
    }
    writer.end();
}

std::shared_ptr<const AccelData> map_accel(const MemoryFile& file, const PluginRegistry& plugins) {
    struct Mapped {
        std::shared_ptr<const char> memory;  // of slots and leaves
        AccelData accel;
    };
    const auto mapped = std::make_shared<Mapped>();
    mapped->memory = map_file(file.fd(), file.bytes());
    AccelData& accel = mapped->accel;
    AccelReader reader(mapped->memory.get(), file.bytes());
    std::string plugin, layout;
    std::vector<PlainMembers> plain;
    Named<rt_u32> defines;
    Named<double> stats;
    reader(plugin), reader(layout), reader(plain);
    reader(defines.names), reader(defines.numbers), reader(stats.names), reader(stats.numbers);
    accel.plugin = accel_of(plugins, plugin);
    accel.layout = accel_of(plugins, layout);
    const PlainMembers& values = plain.at(0);
    accel.leaf_count = values.leaf_count, accel.bytes = values.bytes;
    accel.build_ms = values.build_ms, accel.pack_ms = values.pack_ms;
    accel.scene.bounds = {values.min, values.max, values.empty_bounds != 0};
    defines.each([&](const std::string& name, rt_u32 value) { accel.defines[name] = value; });
    stats.each([&](const std::string& label, double value) { accel.stats.emplace_back(label, value); });
    visit_scene(reader, accel, accel.scene);
    accel.leaves = reader.borrow();
    for (uint32_t s = 0; s < values.slot_count; ++s) {
        std::vector<uint64_t> count;
        reader(count);
        accel.slots.push_back({reader.borrow(), count.at(0)});
    }
    return {mapped, &accel};
}

}  // namespace clarity
