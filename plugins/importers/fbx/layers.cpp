#include "layers.hpp"

#include <algorithm>

#include "../common/smooth_normals.hpp"

namespace fbx_import {

Layer::Layer(Mapping mapping, size_t width, std::vector<float> values, std::vector<int32_t> indices)
    : mapping_(values.size() < width ? none : mapping),
      is_indexed_(!indices.empty()),
      width_(width),
      values_(std::move(values)),
      indices_(std::move(indices)) {}

// MappingInformationType: ByPolygonVertex, ByVertice (also ByVertex), ByPolygon, AllSame, ByEdge. ReferenceInformationType:
// Direct, IndexToDirect, and Index, its older name. Source: FBX SDK help, "FbxLayerElement"; "ByVertice": measured from
// zbrush_d20_6100_ascii. Values of edges are left out: corners have none.
Layer::Layer(const Document& document, const Node* layer, const char* values, const char* indices, size_t width) {
    if (!layer) return;
    const std::string_view mapping = document.text(layer, "MappingInformationType");
    const std::string_view reference = document.text(layer, "ReferenceInformationType");
    if (mapping == "ByEdge" || mapping == "NoMappingInformation") return;
    // Old exporters write IndexToDirect without indices, and mean Direct.
    const bool is_indexed = reference == "IndexToDirect" || reference == "Index";
    *this = Layer(mapping == "ByPolygonVertex"                      ? by_corner
                  : mapping == "ByVertice" || mapping == "ByVertex" ? by_vertex
                  : mapping == "ByPolygon"                          ? by_face
                  : mapping == "AllSame"                            ? all_same
                                                                    : unknown,
                  width, document.numbers<float>(layer, values),
                  is_indexed ? document.numbers<int32_t>(layer, indices) : std::vector<int32_t>());
}

void Layer::settle(const MeshCounts& counts) {
    if (mapping_ != unknown) return;
    const size_t count = is_indexed_ ? indices_.size() : values_.size() / width_;
    mapping_ = count == 1                 ? all_same
               : count == counts.vertices ? by_vertex
               : count == counts.corners  ? by_corner
               : count == counts.faces    ? by_face
                                          : none;
}

const float* Layer::at(const Corner& corner) const {
    static constexpr float zeros[3] = {};
    return at(corner, zeros);
}

const float* Layer::at(const Corner& corner, const float* none) const {
    size_t i = mapping_ == by_corner   ? corner.corner
               : mapping_ == by_vertex ? corner.vertex
               : mapping_ == by_face   ? corner.face
                                       : 0;
    if (is_indexed_) {
        if (i >= indices_.size() || indices_[i] < 0) return none;
        i = static_cast<size_t>(indices_[i]);
    }
    return (i + 1) * width_ <= values_.size() ? &values_[i * width_] : none;
}

std::vector<int32_t> material_slots(const Document& document, const Node& geometry, size_t faces) {
    const Node* layer = document.child(&geometry, "LayerElementMaterial");
    // Up to version 5.8: `MaterialAssignation: "ByPolygon"` and `Materials` in the model itself (measured from
    // max2009_blob_5800_ascii).
    std::string_view mapping = document.text(&geometry, "MaterialAssignation");
    if (layer) mapping = document.text(layer, "MappingInformationType");
    std::vector<int32_t> slots = document.numbers<int32_t>(layer ? layer : &geometry, "Materials");
    for (int32_t& slot : slots) slot = std::max(slot, 0);
    if (slots.empty()) return {};
    if (mapping == "ByPolygon") slots.resize(faces, 0);
    if (mapping != "ByPolygon") slots = std::vector<int32_t>(faces, slots[0]);
    if (std::all_of(slots.begin(), slots.end(), [](int32_t slot) { return slot == 0; })) slots.clear();
    return slots;
}

// LayerElementSmoothing, ByPolygon: groups as bits; faces that share one are smooth where they meet. ByEdge: 1 for smooth
// edges; `Edges` names the corner at which each of them begins. Source: FBX SDK help, "FbxLayerElementSmoothing"; `Edges`:
// Blender developer blog.
std::vector<float> normals_of_smoothing(const Document& document, const Node& geometry, const std::vector<float>& positions,
                                        const std::vector<int32_t>& corners, const std::vector<uint32_t>& sizes) {
    const Node* layer = document.child(&geometry, "LayerElementSmoothing");
    const std::vector<int32_t> values = document.numbers<int32_t>(layer, "Smoothing");
    if (std::all_of(values.begin(), values.end(), [](int32_t value) { return value == 0; })) return {};
    const std::string_view mapping = document.text(layer, "MappingInformationType");
    std::vector<int32_t> of_corner(corners.size());  // the groups of its face, or whether the edge that begins there is smooth
    if (mapping == "ByEdge") {
        const std::vector<int32_t> edges = document.numbers<int32_t>(&geometry, "Edges");
        for (size_t i = 0; i < std::min(edges.size(), values.size()); ++i) {
            const auto corner = static_cast<uint32_t>(edges[i]);
            if (corner < corners.size()) of_corner[corner] = values[i];
        }
        return importers::smooth_normals(positions, corners, sizes,
                                         [&](size_t a, size_t b) { return of_corner[a] != 0 || of_corner[b] != 0; });
    }
    if (mapping != "ByPolygon") return {};
    for_corners(corners, sizes, [&](const Corner& c) { of_corner[c.corner] = c.face < values.size() ? values[c.face] : 0; });
    return importers::smooth_normals(positions, corners, sizes,
                                     [&](size_t a, size_t b) { return (of_corner[a] & of_corner[b]) != 0; });
}

}  // namespace fbx_import
