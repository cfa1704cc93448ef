#include "flat_importer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace openmesh_import {
namespace {

// Limit of the search among the attribute sets of one vertex (for example at the hub of a fan). Beyond it, a new copy of the
// vertex is made without a further search.
constexpr int kMaxChain = 32;

}  // namespace

void FlatImporter::mark_unusable(size_t vertex) {
    if (unusable_.size() <= vertex) unusable_.resize(vertex + 1, false);
    unusable_[vertex] = true;
}

void FlatImporter::reserve(unsigned vertices, unsigned, unsigned faces) {
    positions.reserve(3 * size_t(vertices));
    face_sizes.reserve(faces);
    indices.reserve(3 * size_t(faces));
}

FlatImporter::VertexHandle FlatImporter::add_vertex(const Vec3f& point) {
    const VertexHandle handle(static_cast<int>(file_vertices_++));
    positions.resize(3 * file_vertices_);
    set_point(handle, point);
    return handle;
}

void FlatImporter::set_point(VertexHandle v, const Vec3f& point) {
    if (!v.is_valid() || size_t(v.idx()) >= file_vertices_) return;
    const bool finite = std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
    if (!finite) mark_unusable(size_t(v.idx()));
    for (int k = 0; k < 3; ++k) positions[3 * size_t(v.idx()) + k] = finite ? point[k] : 0;
}

// ---- normals and texture coordinates

FlatImporter::Corner& FlatImporter::corner_of(int vertex, bool Corner::*has) {
    if (corners_.empty() || corners_.back().vertex != vertex || corners_.back().*has) {
        corners_.emplace_back();
        corners_.back().vertex = vertex;
    }
    corners_.back().*has = true;
    return corners_.back();
}

void FlatImporter::set_normal(VertexHandle v, const Vec3f& normal) {
    if (!v.is_valid() || size_t(v.idx()) >= file_vertices_) return;
    if (!(std::isfinite(normal[0]) && std::isfinite(normal[1]) && std::isfinite(normal[2]))) return;
    normals.resize(3 * file_vertices_);
    float* out = attributes_of_corners_ ? corner_of(v.idx(), &Corner::has_normal).values.normal : &normals[3 * size_t(v.idx())];
    for (int k = 0; k < 3; ++k) out[k] = normal[k];
}

void FlatImporter::set_texcoord(VertexHandle v, const Vec2f& uv) {
    if (!v.is_valid() || size_t(v.idx()) >= file_vertices_ || !std::isfinite(uv[0]) || !std::isfinite(uv[1])) return;
    uvs.resize(2 * file_vertices_);
    float* out = attributes_of_corners_ ? corner_of(v.idx(), &Corner::has_uv).values.uv : &uvs[2 * size_t(v.idx())];
    for (int k = 0; k < 2; ++k) out[k] = uv[k];
}

void FlatImporter::store(rt_u32 vertex, const Attributes& values) {
    if (!normals.empty()) std::copy(values.normal, values.normal + 3, &normals[3 * size_t(vertex)]);
    if (!uvs.empty()) std::copy(values.uv, values.uv + 2, &uvs[2 * size_t(vertex)]);
}

// Returns a vertex at the same position with these attributes: the file's own vertex for the first set, a copy for each further
// set.
rt_u32 FlatImporter::variant_of(rt_u32 vertex, const Attributes& values) {
    if (variants_.size() < positions.size() / 3) {
        variants_.resize(positions.size() / 3);
        is_used_.resize(positions.size() / 3, false);
    }
    if (!is_used_[vertex]) {
        is_used_[vertex] = true;
        variants_[vertex].values = values;
        return vertex;
    }
    rt_u32 last = vertex;
    for (int step = 0;; ++step) {
        if (std::memcmp(&variants_[last].values, &values, sizeof values) == 0) return last;
        if (variants_[last].next == RT_NONE || step == kMaxChain) break;
        last = variants_[last].next;
    }
    const rt_u32 copy = static_cast<rt_u32>(positions.size() / 3);
    const float at[3] = {positions[3 * size_t(vertex)], positions[3 * size_t(vertex) + 1], positions[3 * size_t(vertex) + 2]};
    positions.insert(positions.end(), at, at + 3);
    variants_.push_back({values, variants_[last].next});
    variants_[last].next = copy;
    is_used_.push_back(true);
    return copy;
}

void FlatImporter::set_corner_uvs(const std::function<const std::vector<float>*(size_t)>& uvs_of_face) {
    uvs.resize(2 * file_vertices_);
    size_t first = 0;
    for (size_t face = 0; face < face_sizes.size(); first += face_sizes[face++]) {
        const std::vector<float>* list = uvs_of_face(face);
        const bool fits = list && list->size() == 2 * size_t(face_sizes[face]);
        for (size_t i = 0; i < face_sizes[face]; ++i) {
            Attributes values;
            const rt_u32 vertex = indices[first + i];
            if (!normals.empty()) std::copy(&normals[3 * size_t(vertex)], &normals[3 * size_t(vertex)] + 3, values.normal);
            for (int k = 0; k < 2 && fits; ++k) {
                const float x = (*list)[2 * i + k];
                values.uv[k] = std::isfinite(x) ? x : 0;
            }
            indices[first + i] = variant_of(vertex, values);
        }
    }
}

// ---- faces

bool FlatImporter::is_usable(int vertex) const {
    if (vertex < 0 || size_t(vertex) >= file_vertices_) return false;
    return size_t(vertex) >= unusable_.size() || !unusable_[size_t(vertex)];
}

void FlatImporter::report_broken(int vertex) {
    if (broken_faces++ > 0) return;
    const size_t line = line_number ? line_number() : 0;
    if (line > 0) first_broken = "line " + std::to_string(line) + ": ";
    // Vertex numbers in messages: OBJ (the only format here with attributes of corners) counts from 1, the others from 0.
    const bool exists = vertex >= 0 && size_t(vertex) < file_vertices_;
    first_broken += "vertex " + std::to_string(vertex + (attributes_of_corners_ ? 1 : 0));
    first_broken += exists ? " is not finite" : ", and there are " + std::to_string(file_vertices_);
}

FlatImporter::FaceHandle FlatImporter::add_face(const VHandles& vertices) {
    const FaceHandle handle(static_cast<int>(face_sizes.size()));
    const auto broken = std::find_if(vertices.begin(), vertices.end(), [&](VertexHandle v) { return !is_usable(v.idx()); });
    if (broken != vertices.end()) report_broken(broken->idx());
    if (material_of_next_face) face_materials.push_back(material_of_next_face());
    face_sizes.push_back(broken == vertices.end() ? static_cast<rt_u32>(vertices.size()) : 0);
    if (face_sizes.back() == 0) {
        corners_.clear();
        return handle;
    }
    size_t corner = 0;
    const bool has_attributes = attributes_of_corners_ && (!normals.empty() || !uvs.empty());
    for (const VertexHandle vertex : vertices) {
        rt_u32 index = static_cast<rt_u32>(vertex.idx());
        if (has_attributes) {
            Attributes values;
            while (corner < corners_.size() && corners_[corner].vertex != vertex.idx()) ++corner;
            if (corner < corners_.size()) {
                values = corners_[corner++].values;
            } else {
                corner = 0;
            }
            index = variant_of(index, values);
        }
        indices.push_back(index);
    }
    corners_.clear();
    return handle;
}

FlatImporter::HalfedgeHandle FlatImporter::add_edge(VertexHandle from, VertexHandle to) {
    const HalfedgeHandle first(static_cast<int>(halfedges_.size()));
    halfedges_.push_back({to.idx(), -1});
    halfedges_.push_back({from.idx(), -1});
    return first;
}

FlatImporter::FaceHandle FlatImporter::add_face(HalfedgeHandle halfedge) {
    face_halfedges_.push_back(halfedge.idx());
    return FaceHandle(static_cast<int>(face_halfedges_.size()) - 1);
}

void FlatImporter::set_next(HalfedgeHandle halfedge, HalfedgeHandle next) {
    if (halfedge.is_valid() && size_t(halfedge.idx()) < halfedges_.size()) halfedges_[size_t(halfedge.idx())].next = next.idx();
}

void FlatImporter::follow_halfedges() {
    // Each half-edge bounds at most one face. So a valid file needs at most as many steps as it has half-edges.
    size_t steps = 0;
    VHandles vertices;
    const std::vector<int> starts = std::move(face_halfedges_);
    face_halfedges_.clear();
    for (const int start : starts) {
        vertices.clear();
        int at = start;
        do {
            if (at < 0 || size_t(at) >= halfedges_.size() || ++steps > halfedges_.size()) {
                throw std::runtime_error("the half-edges of face " + std::to_string(n_faces()) + " do not form a loop");
            }
            vertices.push_back(VertexHandle(halfedges_[size_t(at)].to));
            at = halfedges_[size_t(at)].next;
        } while (at != start);
        add_face(vertices);
    }
}

void FlatImporter::finish_faces() {
    follow_halfedges();
    const size_t count = positions.size() / 3;
    if (!normals.empty()) normals.resize(3 * count);
    if (!uvs.empty()) uvs.resize(2 * count);
    for (size_t v = 0; v < variants_.size(); ++v) {
        if (is_used_[v]) store(static_cast<rt_u32>(v), variants_[v].values);
    }
    size_t kept = 0;
    for (size_t face = 0; face < face_sizes.size(); ++face) {
        if (face_sizes[face] == 0) continue;
        face_sizes[kept] = face_sizes[face];
        if (!face_materials.empty()) face_materials[kept] = face_materials[face];
        ++kept;
    }
    face_sizes.resize(kept);
    if (!face_materials.empty()) face_materials.resize(kept);
}

}  // namespace openmesh_import
