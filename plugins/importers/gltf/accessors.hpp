// accessors.hpp -- buffers, views of them, and accessors (glTF 2.0 specification, section 3.6). Counts and offsets are checked
// against the bytes that are there before anything is read or allocated.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "document.hpp"

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
    explicit Accessors(const Document& document);

    // Reads the accessor with the index `reference`. types: the types that are allowed there, "VEC2" or "VEC3 VEC4". count: how
    // many elements it must have. Normalised integers become -1..1 or 0..1.
    Elements<float> floats(const Value& reference, std::string_view types, uint64_t count = kAnyCount);
    // For indices and numbers of joints. Refuses floats and signed integers.
    Elements<uint32_t> integers(const Value& reference, std::string_view types, uint64_t count = kAnyCount);
    // Whether the accessor has data of its own, or is all zeros.
    bool has_view(const Value& reference) const;
    // The bytes of the view with the index `reference`.
    std::string_view view(const Value& reference);

 private:
    struct Range;
    template <class T>
    Elements<T> read(const Value& reference, std::string_view types, uint64_t count, bool integers_only);
    template <class T>
    void read_sparse(const Value& sparse, Range values, Elements<T>& out);
    void bind(const Value& owner, Range& range);
    std::string_view buffer(size_t index);
    std::string_view file(const Value& uri, size_t index);

    const Document& document_;
    const Value accessors_, views_, buffers_;
    struct Buffer {
        bool is_read = false;
        std::string decoded;  // of a data URI
        std::unique_ptr<importers::MappedFile> file;
        std::string_view bytes;
    };
    std::vector<Buffer> read_;
};

// Decodes "data:...;base64,..." into `out`. Returns false if the text is no data URI. Throws Error if it is broken.
bool decode_data_uri(const Value& uri, std::string& out);
std::string percent_decoded(std::string_view text);  // replaces %20 and the like
// Decodes it, and throws Error if it does not name a file beside the scene.
std::string relative_path(const Value& uri);

}  // namespace gltf_import
