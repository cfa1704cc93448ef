#include "accessors.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "../common/base64.hpp"

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

const Component& component_of(const Value& owner, bool integers_only) {
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

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    c = static_cast<char>(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
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

Accessors::Accessors(const Document& document)
    : document_(document),
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

template <class T>
Elements<T> Accessors::read(const Value& reference, std::string_view types, uint64_t count, bool integers_only) {
    const Value accessor = accessors_[reference.index(accessors_)];
    Range range;
    range.components = type_of(accessor, types, reference);
    const Component& component = component_of(accessor, integers_only);
    range.component_type = component.code;
    range.component_bytes = component.bytes;
    range.count = accessor["count"].count();
    range.is_normalized = accessor.has("normalized") && accessor["normalized"].json() == true;
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
    const Component& component = component_of(sparse["indices"], true);
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
    const Value reference = owner["bufferView"], view = views_[reference.index(views_)];
    const std::string_view bytes = this->view(reference);
    const uint64_t offset = owner.count("byteOffset", 0), element = range.component_bytes * range.components;
    const uint64_t stride = view.count("byteStride", element);
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
    const Value view = views_[reference.index(views_)];
    if (view.object("extensions").has("EXT_meshopt_compression"))
        view.refuse("data compressed with EXT_meshopt_compression", "plain data: export the file again without compression");
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
    const Value buffer = buffers_[index];
    const uint64_t length = buffer["byteLength"].count();
    if (!buffer.has("uri")) {
        if (index != 0 || !document_.has_binary())
            buffer.refuse("no member 'uri'", "it there: only the first buffer of a .glb file has none");
        out.bytes = document_.binary();
    } else if (const Value uri = buffer["uri"]; decode_data_uri(uri, out.decoded)) {
        out.bytes = out.decoded;
    } else {
        const std::string name = relative_path(uri);
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
    return out.bytes;
}

std::string percent_decoded(std::string_view text) {
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        const bool is_code =
            text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
        out += is_code ? static_cast<char>(16 * hex_digit(text[i + 1]) + hex_digit(text[i + 2])) : text[i];
        if (is_code) i += 2;
    }
    return out;
}

bool decode_data_uri(const Value& uri, std::string& out) {
    if (!uri.json().is_string()) uri.refuse("a text");
    const std::string_view text = uri.json().get_ref<const std::string&>();
    if (text.substr(0, 5) != "data:") return false;
    const size_t comma = text.find(',');
    if (comma == text.npos) uri.refuse("a comma between the kind of the data and the data");
    const std::string_view head = text.substr(0, comma), data = text.substr(comma + 1);
    if (head.size() < 7 || head.substr(head.size() - 7) != ";base64") {
        out = percent_decoded(data);
    } else if (const size_t bad = importers::decode_base64(data, out); bad != data.npos) {
        uri.refuse(in_quotes(data.substr(bad, 1)) + " at character " + std::to_string(comma + 1 + bad), "base64");
    }
    return true;
}

std::string relative_path(const Value& uri) {
    std::string path = percent_decoded(uri.text());
    std::replace(path.begin(), path.end(), '\\', '/');
    while (path.compare(0, 2, "./") == 0) path.erase(0, 2);
    const size_t colon = path.find(':');
    const bool has_scheme = colon != path.npos && path.find('/') >= colon;
    const bool leaves = path.compare(0, 3, "../") == 0 || path.find("/../") != path.npos;
    if (path.empty() || path[0] == '/' || has_scheme || leaves || path.find('\0') != path.npos)
        uri.refuse("the name of a file in the scene's folder, or data");
    return path;
}

}  // namespace gltf_import
