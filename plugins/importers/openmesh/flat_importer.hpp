// flat_importer.hpp -- receives vertices and faces from OpenMesh's readers in flat arrays, without OpenMesh's mesh.
//
// A half-edge mesh cannot hold three faces at one edge, so OpenMesh would drop such faces. Arrays hold every face of the file,
// and take a fraction of the memory and time.
#pragma once
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace openmesh_import {

// Stores properties that the readers have no other place for (custom properties of PLY). The counts tell how many values to
// make room for.
class PropertyStore : public OpenMesh::BaseKernel {
 public:
    size_t n_vertices() const override { return vertices; }
    size_t n_halfedges() const override { return 2 * edges; }
    size_t n_edges() const override { return edges; }
    size_t n_faces() const override { return faces; }
    size_t vertices = 0, edges = 0, faces = 0;
};

class FlatImporter : public OpenMesh::IO::BaseImporter {
 public:
    using VertexHandle = OpenMesh::VertexHandle;
    using FaceHandle = OpenMesh::FaceHandle;
    using HalfedgeHandle = OpenMesh::HalfedgeHandle;
    using EdgeHandle = OpenMesh::EdgeHandle;
    using Vec2f = OpenMesh::Vec2f;
    using Vec3f = OpenMesh::Vec3f;

    // attributes_of_corners: normals and uvs belong to the corners of the next face (OBJ) instead of to vertices (all other
    // formats).
    explicit FlatImporter(bool attributes_of_corners) : attributes_of_corners_(attributes_of_corners) {}

    PropertyStore properties;
    std::function<rt_u32()> material_of_next_face;  // may be empty
    std::function<size_t()> line_number;            // may be empty; line of the file, for messages

    // Marks a vertex with coordinates that could not be read. Faces must not use it.
    void mark_unusable(size_t vertex);
    // Sets uvs per corner, in the order of the faces; PLY stores them in lists. A list is ignored if its size differs from
    // the face's.
    void set_corner_uvs(const std::function<const std::vector<float>*(size_t face)>& uvs_of_face);
    // Call it after reading: it makes faces of half-edges (OM), and removes faces without corners.
    void finish_faces();

    // The results; see rt_mesh.
    std::vector<float> positions, normals, uvs;
    std::vector<rt_u32> indices, face_sizes, face_materials;

    size_t face_count() const { return face_sizes.size(); }
    // broken_faces counts faces that refer to a missing vertex or one that is not finite. They stay without corners until
    // finish_faces(). first_broken describes the first of them.
    uint64_t broken_faces = 0;
    std::string first_broken;

    // ---- called by the readers
    VertexHandle add_vertex(const Vec3f& point) override;
    VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
    FaceHandle add_face(const VHandles& vertices) override;
    void set_point(VertexHandle v, const Vec3f& point) override;
    void set_normal(VertexHandle v, const Vec3f& normal) override;
    void set_normal(VertexHandle v, const OpenMesh::Vec3d& normal) override { set_normal(v, Vec3f(normal)); }
    void set_texcoord(VertexHandle v, const Vec2f& uv) override;
    // 3D texture coordinates are ignored; the reader sets 2D ones first.
    void set_texcoord(VertexHandle, const Vec3f&) override {}
    OpenMesh::BaseKernel* kernel() override { return &properties; }
    void reserve(unsigned vertices, unsigned edges, unsigned faces) override;
    size_t n_vertices() const override { return file_vertices_; }
    size_t n_faces() const override { return face_sizes.size() + face_halfedges_.size(); }
    size_t n_edges() const override { return halfedges_.size() / 2; }

    // Half-edges. OM 2 stores its faces as half-edges.
    HalfedgeHandle add_edge(VertexHandle from, VertexHandle to) override;
    FaceHandle add_face(HalfedgeHandle halfedge) override;
    void set_next(HalfedgeHandle halfedge, HalfedgeHandle next) override;
    void set_face(HalfedgeHandle, FaceHandle) override {}
    void set_halfedge(VertexHandle, HalfedgeHandle) override {}

    // Data that the importer does not need.
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
    void set_face_texindex(FaceHandle, int) override {}
    void request_face_texcoords2D() override {}
    void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
    void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
    void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec4f&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec3f&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec4f&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec4f&) override {}
    void set_normal(FaceHandle, const Vec3f&) override {}
    void set_normal(FaceHandle, const OpenMesh::Vec3d&) override {}
    void add_texture_information(int, std::string) override {}

 private:
    struct Halfedge {
        int to = -1, next = -1;
    };
    struct Attributes {
        float normal[3] = {0, 0, 0}, uv[2] = {0, 0};
    };
    // The attributes of one corner of the next face.
    struct Corner {
        int vertex = -1;
        bool has_normal = false, has_uv = false;
        Attributes values;
    };
    // One vertex with one set of attributes. `next` links to the vertex with the next set.
    struct Variant {
        Attributes values;
        rt_u32 next = RT_NONE;
    };
    Corner& corner_of(int vertex, bool Corner::*has);
    rt_u32 variant_of(rt_u32 vertex, const Attributes& values);
    void store(rt_u32 vertex, const Attributes& values);
    bool is_usable(int vertex) const;
    void report_broken(int vertex);
    void follow_halfedges();

    const bool attributes_of_corners_;
    size_t file_vertices_ = 0;
    std::vector<bool> unusable_;
    std::vector<Corner> corners_;
    std::vector<Variant> variants_;  // one per vertex, if attributes belong to corners
    std::vector<bool> is_used_;      // true: variants_ holds the attributes of the vertex
    std::vector<Halfedge> halfedges_;
    std::vector<int> face_halfedges_;
};

}  // namespace openmesh_import
