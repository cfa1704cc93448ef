// compressed.hpp -- geometry that libraries decompress. Each of them may be missing when the importer is built; then files that
// need it are refused with a message that names it.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "value.hpp"

namespace gltf_import {

// EXT_meshopt_compression. Decodes the bytes of a view: `extension` says how. Throws Error if they are broken.
std::string decode_meshopt(const Value& extension, std::string_view bytes);

// KHR_draco_mesh_compression: a primitive's triangles and attributes.
class DracoMesh {
 public:
    // Decodes the bytes; `extension` is for messages. Throws Error if they are broken.
    DracoMesh(const Value& extension, std::string_view bytes);
    ~DracoMesh();
    uint64_t vertex_count() const;
    std::vector<uint32_t> indices() const;  // three for each triangle
    // The values of an attribute, by its id: `components` for each vertex. id: its place in the file. is_normalized: whole
    // numbers become -1..1 or 0..1, as those of this glTF component type. Throws Error if there is no such attribute.
    std::vector<float> floats(const Value& id, size_t components, bool is_normalized, uint64_t component_type) const;
    std::vector<uint32_t> integers(const Value& id, size_t components) const;

 private:
    struct Decoded;
    template <class T>
    std::vector<T> values(const Value& id, size_t components) const;
    std::unique_ptr<Decoded> decoded_;
};

}  // namespace gltf_import
