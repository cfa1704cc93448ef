// draco.cpp -- KHR_draco_mesh_compression: primitives that Draco has compressed.
#include <algorithm>
#include <limits>

#include "compressed.hpp"
#ifdef CLARITY_HAVE_DRACO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/decode.h>
#pragma GCC diagnostic pop
#endif

namespace gltf_import {

#ifdef CLARITY_HAVE_DRACO
struct DracoMesh::Decoded {
    std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(const Value& extension, std::string_view bytes) : decoded_(std::make_unique<Decoded>()) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    draco::StatusOr<std::unique_ptr<draco::Mesh>> result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok())
        extension.refuse("bytes that Draco cannot decode: " + in_quotes(result.status().error_msg_string()),
                         "a compressed mesh");
    decoded_->mesh = std::move(result).value();
    if (!decoded_->mesh) extension.refuse("bytes without a mesh", "a compressed mesh");
}

uint64_t DracoMesh::vertex_count() const {
    return decoded_->mesh->num_points();
}

std::vector<uint32_t> DracoMesh::indices() const {
    const draco::Mesh& mesh = *decoded_->mesh;
    std::vector<uint32_t> out;
    out.reserve(3 * size_t(mesh.num_faces()));
    for (uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) out.push_back(corner.value());
    return out;
}

template <class T>
std::vector<T> DracoMesh::values(const Value& id, size_t components) const {
    const draco::Mesh& mesh = *decoded_->mesh;
    const uint64_t number = id.count();
    const draco::PointAttribute* const attribute =
        number <= std::numeric_limits<uint32_t>::max() ? mesh.GetAttributeByUniqueId(static_cast<uint32_t>(number)) : nullptr;
    if (!attribute) id.refuse("the id of an attribute in the compressed mesh");
    if (size_t(attribute->num_components()) < components)
        id.refuse("an attribute of " + std::to_string(attribute->num_components()) + " numbers",
                  std::to_string(components) + " for each vertex");
    std::vector<T> out(components * size_t(mesh.num_points()));
    for (uint32_t p = 0; p < mesh.num_points(); ++p) {
        const bool is_mapped = attribute->is_mapping_identity() || p < attribute->indices_map_size();
        const draco::AttributeValueIndex at =
            is_mapped ? attribute->mapped_index(draco::PointIndex(p)) : draco::kInvalidAttributeValueIndex;
        if (at.value() >= attribute->size() ||
            !attribute->ConvertValue<T>(at, static_cast<int8_t>(components), &out[components * p]))
            id.refuse("an attribute without a usable value for vertex " + std::to_string(p), "one for each vertex");
    }
    return out;
}

std::vector<float> DracoMesh::floats(const Value& id, size_t components, bool is_normalized, uint64_t component_type) const {
    const draco::PointAttribute* const attribute =
        decoded_->mesh->GetAttributeByUniqueId(static_cast<uint32_t>(std::min<uint64_t>(id.count(), 0xFFFFFFFFu)));
    std::vector<float> out = values<float>(id, components);
    // Draco has divided numbers that it knows to be normalized.
    const bool is_whole = attribute->data_type() >= draco::DT_INT8 && attribute->data_type() <= draco::DT_UINT64;
    if (!is_normalized || !is_whole || attribute->normalized()) return out;
    const float most = component_type == 5120   ? 127.f
                       : component_type == 5121 ? 255.f
                       : component_type == 5122 ? 32767.f
                       : component_type == 5123 ? 65535.f
                                                : 1.f;
    for (float& x : out) x = std::max(x / most, -1.f);
    return out;
}

std::vector<uint32_t> DracoMesh::integers(const Value& id, size_t components) const {
    return values<uint32_t>(id, components);
}
#else
struct DracoMesh::Decoded {};

DracoMesh::DracoMesh(const Value& extension, std::string_view) {
    extension.refuse("data compressed with KHR_draco_mesh_compression",
                     "plain data, because this importer was built without Draco: install libdraco-dev and build it again, or "
                     "export the file without compression");
}
uint64_t DracoMesh::vertex_count() const {
    return 0;
}
std::vector<uint32_t> DracoMesh::indices() const {
    return {};
}
std::vector<float> DracoMesh::floats(const Value&, size_t, bool, uint64_t) const {
    return {};
}
std::vector<uint32_t> DracoMesh::integers(const Value&, size_t) const {
    return {};
}
#endif

DracoMesh::~DracoMesh() = default;

}  // namespace gltf_import
