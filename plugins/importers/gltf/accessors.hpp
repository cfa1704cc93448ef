// accessors.hpp -- buffers, views of them, and accessors (glTF 2.0 specification, section 3.6). Counts and offsets are checked
// against the bytes that are there before anything is read or allocated.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "document.hpp"
#include "rt_plugin.h"

namespace gltf_import {

constexpr uint64_t kAnyCount = ~uint64_t(0);

template <class T>
struct Elements {
    std::vector<T> values;
    size_t components = 0;  // of an element: 3 for VEC3
    uint64_t count = 0;
};

class Accessors {
 public:
    // sink: gets warnings.
    Accessors(const Document& document, const rt_scene_sink& sink);

    // Reads the accessor with the index `reference`. types: the types that are allowed there, "VEC2" or "VEC3 VEC4". count: how
    // many elements it must have. Normalised integers become -1..1 or 0..1.
    Elements<float> floats(const Value& reference, std::string_view types, uint64_t count = kAnyCount);
    // For indices and numbers of joints. Refuses floats and signed integers.
    Elements<uint32_t> integers(const Value& reference, std::string_view types, uint64_t count = kAnyCount);
    // Whether the accessor has data of its own, or is all zeros.
    bool has_view(const Value& reference) const;
    // The bytes of the view with the index `reference`, decompressed.
    std::string_view view(const Value& reference);
    // What a primitive says of an accessor without reading its data.
    struct Form {
        uint64_t count = 0, component_type = 0;
        size_t components = 0;
        bool is_normalized = false;
    };
    Form form(const Value& reference, std::string_view types, bool integers_only) const;

 private:
    struct Range;
    template <class T>
    Elements<T> read(const Value& reference, std::string_view types, uint64_t count, bool integers_only);
    template <class T>
    void read_sparse(const Value& sparse, Range values, Elements<T>& out);
    void bind(const Value& owner, Range& range);
    std::string_view slice(const Value& view);
    std::string_view buffer(size_t index);
    struct Buffer;
    void read_buffer(size_t index, Buffer& out);

    const Document& document_;
    const rt_scene_sink& sink_;
    const Value accessors_, views_, buffers_;
    struct Buffer {
        bool is_read = false;
        std::string why;      // it cannot be read
        std::string decoded;  // of a data URI
        std::unique_ptr<importers::MappedFile> file;
        std::string_view bytes;
    };
    std::vector<Buffer> read_;
    std::map<size_t, std::string> decompressed_;  // by the number of the view
    std::map<size_t, std::string> broken_;        // why, by the number of the view
    std::set<size_t> warned_;                     // views of which a warning was given
};

}  // namespace gltf_import
