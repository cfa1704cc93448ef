// layers.hpp -- the data that a geometry has for its corners and faces: normals, texture coordinates, material slots.
#pragma once
#include "document.hpp"

namespace fbx_import {

// A corner of a face: its number, its vertex and its face.
struct Corner {
    size_t corner, vertex, face;
};
// Calls body(corner) for each corner. vertices: one for each. sizes: corners of each face; empty: three.
template <class Body>
void for_corners(const std::vector<int32_t>& vertices, const std::vector<uint32_t>& sizes, const Body& body) {
    const auto size_of = [&](size_t face) { return face < sizes.size() ? sizes[face] : 3; };
    Corner c{0, 0, 0};
    for (size_t left = size_of(0); c.corner < vertices.size(); ++c.corner) {
        c.vertex = static_cast<uint32_t>(vertices[c.corner]);
        body(c);
        if (--left == 0) left = size_of(++c.face);
    }
}
struct MeshCounts {
    size_t corners = 0, vertices = 0, faces = 0;
};

class Layer {
 public:
    enum Mapping { none, unknown, by_corner, by_vertex, by_face, all_same };
    Layer() = default;
    // `width` values for each element. indices: which of these groups of values each element has; empty: they are in order.
    Layer(Mapping mapping, size_t width, std::vector<float> values, std::vector<int32_t> indices = {});
    // layer: a node such as LayerElementNormal, or nullptr; its numbers are in `values`, and their indices in `indices`.
    Layer(const Document& document, const Node* layer, const char* values, const char* indices, size_t width);

    bool empty() const { return mapping_ == none; }
    // Finds an unknown mapping by the count of elements. Call it before `at`.
    void settle(const MeshCounts& counts);
    // The numbers of a corner, or zeros (`none`) if the file has none.
    const float* at(const Corner& corner) const;
    const float* at(const Corner& corner, const float* none) const;

 private:
    Mapping mapping_ = none;
    bool is_indexed_ = false;
    size_t width_ = 1;
    std::vector<float> values_;
    std::vector<int32_t> indices_;
};

// The material slot of each face; empty: all have slot 0.
std::vector<int32_t> material_slots(const Document& document, const Node& geometry, size_t faces);

// A normal for each corner, as the file's smoothing groups or smooth edges say. Empty: it has none, or nothing is smooth.
std::vector<float> normals_of_smoothing(const Document& document, const Node& geometry, const std::vector<float>& positions,
                                        const std::vector<int32_t>& corners, const std::vector<uint32_t>& sizes);

}  // namespace fbx_import
