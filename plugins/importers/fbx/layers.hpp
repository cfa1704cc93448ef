// layers.hpp -- what a geometry tells of its corners and faces: normals, texture coordinates, material slots.
#pragma once
#include "document.hpp"

namespace fbx_import {

// Which element of the file a number belongs to.
struct Corner {
    size_t corner, vertex, face;
};
struct MeshCounts {
    size_t corners = 0, vertices = 0, faces = 0;
};

class Layer {
 public:
    // `element`: "LayerElementNormal"; its numbers are in `values`, `width` for each element, and their indices in `indices`.
    Layer(const Document& document, const Node& geometry, const char* element, const char* values, const char* indices,
          size_t width, const MeshCounts& counts);
    Layer() = default;

    bool empty() const { return mapping_ == none; }
    bool is_of_corners() const { return mapping_ == by_corner || mapping_ == by_face; }
    // The numbers of a corner, or nullptr if the file has none.
    const float* at(const Corner& corner) const;

    // The layer of a list of numbers without a mapping, as up to version 5.8.
    static Layer of_list(std::vector<float> values, size_t width, const MeshCounts& counts);
    static Layer of_indices(std::vector<float> values, size_t width, std::vector<int32_t> indices);

 private:
    enum Mapping { none, by_corner, by_vertex, by_face, all_same };
    void guess(const MeshCounts& counts);
    Mapping mapping_ = none;
    bool indexed_ = false;
    size_t width_ = 1;
    std::vector<float> values_;
    std::vector<int32_t> indices_;
};

// The material slot of each face; empty: all have slot 0.
std::vector<int32_t> material_slots(const Document& document, const Node& geometry, size_t faces);

}  // namespace fbx_import
