#include "accessors.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "compressed.hpp"
#include "rt_plugin.hpp"
#include "uri.hpp"

namespace gltf_import {
namespace {

// An accessor without a view is all zeros. No byte of the file stands behind it, so its size needs a limit.
constexpr uint64_t kMostZeros = 1u << 22;

struct Component {
    uint64_t code;
    size_t bytes;
    bool is_signed, is_float;
};
constexpr Component kComponents[] = {{5120, 1, true, false},  {5121, 1, false, false}, {5122, 2, true, false},
                                     {5123, 2, false, false}, {5125, 4, false, false}, {5126, 4, true, true}};
constexpr std::pair<std::string_view, size_t> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};

Component component_of(const Value& owner, bool integers_only) {
    const Value code = owner["componentType"];
    for (const Component& c : kComponents) {
        if (c.code == code.count() && !(integers_only && c.is_signed)) return c;
    }
    code.refuse(integers_only ? "5121, 5123 or 5125 (unsigned integers)" : "5120, 5121, 5122, 5123, 5125 or 5126");
}

size_t type_of(const Value& accessor, std::string_view types, const Value& reference) {
    const std::string type = accessor["type"].text();
    for (const auto& [name, components] : kTypes) {
        if (name == type && types.find(name) != types.npos) return components;
    }
    accessor["type"].refuse(std::string(types) + " for " + reference.path());
}

template <class Raw, class T>
void convert(const char* from, size_t stride, size_t components, uint64_t count, bool is_normalized, T* out) {
    constexpr float kMost =
        sizeof(Raw) < 4 ? float((uint64_t(1) << (8 * sizeof(Raw) - (std::is_signed_v<Raw> ? 1 : 0))) - 1) : 4294967295.0f;
    for (uint64_t i = 0; i < count; ++i, from += stride) {
        for (size_t k = 0; k < components; ++k) {
            Raw raw;
            std::memcpy(&raw, from + k * sizeof raw, sizeof raw);
            T value = static_cast<T>(raw);
            if constexpr (std::is_floating_point_v<T> && std::is_integral_v<Raw>) {
                if (is_normalized) value = std::max(value / kMost, T(-1));
            }
            *out++ = value;
        }
    }
}

}  // namespace

// `count` elements in a view.
struct Accessors::Range {
    uint64_t component_type = 0;  // as the file codes it
    size_t component_bytes = 0;
    size_t components = 0;
    uint64_t count = 0;
    size_t stride = 0;
    bool is_normalized = false;
    const char* first = nullptr;  // nullptr: no view

    template <class T>
    void copy(T* out) const {
        if (count == 0 || !first) return;
        switch (component_type) {
            case 5120:
                return convert<int8_t>(first, stride, components, count, is_normalized, out);
            case 5121:
                return convert<uint8_t>(first, stride, components, count, is_normalized, out);
            case 5122:
                return convert<int16_t>(first, stride, components, count, is_normalized, out);
            case 5123:
                return convert<uint16_t>(first, stride, components, count, is_normalized, out);
            case 5125:
                return convert<uint32_t>(first, stride, components, count, is_normalized, out);
            default:
                if constexpr (std::is_floating_point_v<T>) convert<float>(first, stride, components, count, false, out);
        }
    }
};

Accessors::Accessors(const Document& document, const rt_scene_sink& sink)
    : document_(document),
      sink_(sink),
      accessors_(document.list("accessors")),
      views_(document.list("bufferViews")),
      buffers_(document.list("buffers")),
      read_(buffers_.size()) {}

Elements<float> Accessors::floats(const Value& reference, std::string_view types, uint64_t count) {
    return read<float>(reference, types, count, false);
}

Elements<uint32_t> Accessors::integers(const Value& reference, std::string_view types, uint64_t count) {
    return read<uint32_t>(reference, types, count, true);
}

bool Accessors::has_view(const Value& reference) const {
    return accessors_[reference.index(accessors_)].has("bufferView");
}

Accessors::Form Accessors::form(const Value& reference, std::string_view types, bool integers_only) const {
    const Value accessor = accessors_[reference.index(accessors_)];
    Form form;
    form.components = type_of(accessor, types, reference);
    form.component_type = component_of(accessor, integers_only).code;
    form.count = accessor["count"].count();
    form.is_normalized = accessor.has("normalized") && accessor["normalized"].json() == true;
    return form;
}

template <class T>
Elements<T> Accessors::read(const Value& reference, std::string_view types, uint64_t count, bool integers_only) {
    const Value accessor = accessors_[reference.index(accessors_)];
    const Form form = this->form(reference, types, integers_only);
    Range range;
    range.components = form.components;
    range.component_type = form.component_type;
    range.component_bytes = component_of(accessor, integers_only).bytes;
    range.count = form.count;
    range.is_normalized = form.is_normalized;
    if (count != kAnyCount && range.count != count)
        accessor["count"].refuse(std::to_string(count) + " for " + reference.path());
    const bool has_view = accessor.has("bufferView");
    if (has_view) bind(accessor, range);
    if (!has_view && count == kAnyCount && range.count > kMostZeros)
        accessor["count"].refuse("at most " + std::to_string(kMostZeros) + " in an accessor without a bufferView");
    Elements<T> out;
    out.count = range.count;
    out.components = range.components;
    out.values.resize(range.count * range.components);
    range.copy(out.values.data());
    if (accessor.has("sparse")) read_sparse(accessor["sparse"], range, out);
    return out;
}

template <class T>
void Accessors::read_sparse(const Value& sparse, Range values, Elements<T>& out) {
    values.count = sparse["count"].count();
    if (values.count > out.count) sparse["count"].refuse("at most " + std::to_string(out.count) + ", the accessor's count");
    Range places;
    places.components = 1;
    places.count = values.count;
    const Component component = component_of(sparse["indices"], true);
    places.component_type = component.code;
    places.component_bytes = component.bytes;
    bind(sparse["indices"], places);
    bind(sparse["values"], values);
    std::vector<uint32_t> where(places.count);
    std::vector<T> what(values.count * values.components);
    places.copy(where.data());
    values.copy(what.data());
    for (size_t i = 0; i < where.size(); ++i) {
        if (where[i] >= out.count)
            sparse["indices"].refuse("the index " + std::to_string(where[i]), "indices below " + std::to_string(out.count));
        std::copy_n(&what[i * out.components], out.components, &out.values[where[i] * out.components]);
    }
}

// Finds the elements of `range` in the view that `owner` names.
void Accessors::bind(const Value& owner, Range& range) {
    const Value reference = owner["bufferView"];
    const size_t index = reference.index(views_);
    const Value view = views_[index];
    const std::string_view bytes = this->view(reference);
    const uint64_t offset = owner.count("byteOffset", 0), element = range.component_bytes * range.components;
    uint64_t stride = view.count("byteStride", element);
    if (stride == 0) {
        stride = element;
        if (warned_.insert(index).second)
            rt::warn(sink_, view["byteStride"].path() + ": found 0, expected " + std::to_string(element) +
                                " or more, or no such member; its elements are read as if they follow each other");
    }
    if (stride < element || stride > 65536)
        view["byteStride"].refuse(std::to_string(element) + ", the size of an element of " + owner.path() + ", to 65536");
    if (range.count == 0) return;
    // All numbers are below 2^53, so that nothing overflows before the division.
    const bool fits = offset <= bytes.size() && element <= bytes.size() - offset &&
                      range.count - 1 <= (bytes.size() - offset - element) / stride;
    if (!fits) {
        owner.refuse(std::to_string(range.count) + " elements of " + std::to_string(element) + " bytes, " +
                         std::to_string(stride) + " apart, from byte " + std::to_string(offset),
                     "them inside of the " + std::to_string(bytes.size()) + " bytes of " + view.path());
    }
    range.stride = stride;
    range.first = bytes.data() + offset;
}

std::string_view Accessors::view(const Value& reference) {
    const size_t index = reference.index(views_);
    const Value view = views_[index], extensions = view.object("extensions");
    // KHR_meshopt_compression is its later name.
    const char* const names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
    const auto name = std::find_if(std::begin(names), std::end(names), [&](const char* n) { return extensions.has(n); });
    if (name == std::end(names)) return slice(view);
    const auto known = decompressed_.find(index);
    if (known != decompressed_.end()) return known->second;
    const Value compressed = extensions[*name];
    const size_t own_buffer = view["buffer"].index(buffers_);
    // The view itself may have the same data without compression, for programs that do not know the extension.
    const bool has_plain = own_buffer != compressed["buffer"].index(buffers_) && buffers_[own_buffer].has("uri");
    if (const auto why = broken_.find(index); why != broken_.end()) {
        if (has_plain) return slice(view);
        throw Error(why->second);
    }
    try {
        return decompressed_[index] = decode_meshopt(compressed, slice(compressed));
    } catch (const Error& error) {
        broken_[index] = error.what();
        if (!has_plain) throw;
        rt::warn(sink_, error.what() + std::string("; the data without compression is taken"));
        return slice(view);
    }
}

// The bytes of a buffer that `view` names.
std::string_view Accessors::slice(const Value& view) {
    const size_t index = view["buffer"].index(buffers_);
    const std::string_view bytes = buffer(index);
    const uint64_t offset = view.count("byteOffset", 0), length = view["byteLength"].count();
    if (offset > bytes.size() || length > bytes.size() - offset) {
        view.refuse(std::to_string(length) + " bytes from byte " + std::to_string(offset),
                    "them inside of the " + std::to_string(bytes.size()) + " bytes of " + buffers_[index].path());
    }
    return bytes.substr(offset, length);
}

std::string_view Accessors::buffer(size_t index) {
    Buffer& out = read_[index];
    if (out.is_read) return out.bytes;
    if (!out.why.empty()) throw Error(out.why);
    try {
        read_buffer(index, out);
    } catch (const Error& error) {
        out.why = error.what();
        throw;
    }
    return out.bytes;
}

void Accessors::read_buffer(size_t index, Buffer& out) {
    const Value buffer = buffers_[index];
    const uint64_t length = buffer["byteLength"].count();
    if (!buffer.has("uri")) {
        if (index != 0 || !document_.has_binary())
            buffer.refuse("no member 'uri'", "it there: only the first buffer of a .glb file has none");
        out.bytes = document_.binary();
    } else if (const Value uri = buffer["uri"]; decode_data_uri(uri, out.decoded)) {
        out.bytes = out.decoded;
    } else {
        const std::string name = file_of_uri(uri, document_.folder());
        try {
            out.file = std::make_unique<importers::MappedFile>(document_.folder() + name);
        } catch (const std::runtime_error& error) {
            uri.refuse("a file in the scene's folder, or data; " + std::string(error.what()));
        }
        out.bytes = out.file->bytes();
    }
    if (length > out.bytes.size())
        buffer["byteLength"].refuse("at most " + std::to_string(out.bytes.size()) +
                                    ", the bytes that the buffer has: it is cut off or damaged");
    out.bytes = out.bytes.substr(0, length);
    out.is_read = true;
}

}  // namespace gltf_import
