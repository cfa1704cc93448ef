#include "layers.hpp"

#include <algorithm>

namespace fbx_import {

// MappingInformationType: ByPolygonVertex, ByVertice (also ByVertex), ByPolygon, AllSame, ByEdge. ReferenceInformationType:
// Direct, IndexToDirect, and Index, its older name. Source: FBX SDK help, "FbxLayerElement"; "ByVertice": measured from
// zbrush_d20_6100_ascii. Values of edges cannot be told apart at corners; they are left out.
Layer::Layer(const Document& document, const Node& geometry, const char* element, const char* values, const char* indices,
             size_t width, const MeshCounts& counts)
    : width_(width) {
    const Node* layer = document.child(&geometry, element);
    if (!layer) return;
    const std::string_view mapping = document.text(document.child(layer, "MappingInformationType"), 0);
    const std::string_view reference = document.text(document.child(layer, "ReferenceInformationType"), 0);
    if (mapping == "ByEdge" || mapping == "NoMappingInformation") return;
    values_ = document.numbers<float>(layer, values);
    indexed_ = reference == "IndexToDirect" || reference == "Index";
    if (indexed_) indices_ = document.numbers<int32_t>(layer, indices);
    // Old exporters write IndexToDirect without indices, and mean Direct.
    if (indices_.empty()) indexed_ = false;
    mapping_ = mapping == "ByPolygonVertex"                      ? by_corner
               : mapping == "ByVertice" || mapping == "ByVertex" ? by_vertex
               : mapping == "ByPolygon"                          ? by_face
               : mapping == "AllSame"                            ? all_same
                                                                 : none;
    if (mapping_ == none) guess(counts);
    if (mapping_ == none || values_.size() < width_) *this = Layer();
}

// Tells the mapping by the count of elements.
void Layer::guess(const MeshCounts& counts) {
    const size_t count = indexed_ ? indices_.size() : values_.size() / width_;
    mapping_ = count == counts.vertices  ? by_vertex
               : count == counts.corners ? by_corner
               : count == counts.faces   ? by_face
                                         : none;
    if (count == 1) mapping_ = all_same;
}

Layer Layer::of_list(std::vector<float> values, size_t width, const MeshCounts& counts) {
    Layer out;
    out.width_ = width;
    out.values_ = std::move(values);
    if (out.values_.size() >= width) out.guess(counts);
    return out;
}

Layer Layer::of_indices(std::vector<float> values, size_t width, std::vector<int32_t> indices) {
    Layer out;
    out.width_ = width;
    out.values_ = std::move(values);
    out.indices_ = std::move(indices);
    out.indexed_ = true;
    if (out.values_.size() >= width && !out.indices_.empty()) out.mapping_ = by_corner;
    return out;
}

const float* Layer::at(const Corner& corner) const {
    size_t i = mapping_ == by_corner   ? corner.corner
               : mapping_ == by_vertex ? corner.vertex
               : mapping_ == by_face   ? corner.face
                                       : 0;
    if (indexed_) {
        if (i >= indices_.size() || indices_[i] < 0) return nullptr;
        i = static_cast<size_t>(indices_[i]);
    }
    return (i + 1) * width_ <= values_.size() ? &values_[i * width_] : nullptr;
}

std::vector<int32_t> material_slots(const Document& document, const Node& geometry, size_t faces) {
    const Node* layer = document.child(&geometry, "LayerElementMaterial");
    // Up to version 5.8: `MaterialAssignation: "ByPolygon"` and `Materials` in the model itself (measured from
    // max2009_blob_5800).
    std::string_view mapping = document.text(document.child(&geometry, "MaterialAssignation"), 0);
    if (layer) mapping = document.text(document.child(layer, "MappingInformationType"), 0);
    std::vector<int32_t> slots = document.numbers<int32_t>(layer ? layer : &geometry, "Materials");
    for (int32_t& slot : slots) slot = std::max(slot, 0);
    if (slots.empty()) return {};
    if (mapping != "ByPolygon") slots.assign(slots[0] == 0 ? 0 : faces, slots[0]);
    if (!slots.empty()) slots.resize(faces, 0);
    if (std::all_of(slots.begin(), slots.end(), [](int32_t slot) { return slot == 0; })) slots.clear();
    return slots;
}

}  // namespace fbx_import
