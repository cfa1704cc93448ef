// om.cpp -- reads OM, OpenMesh's own binary format, through its reader. Without OpenMesh (libopenmesh-dev) OM files are
// refused.
#include "readers.hpp"
#ifndef CLARITY_HAVE_OPENMESH
#include <stdexcept>
#else
#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/Options.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <cstring>
#include <istream>
#include <stdexcept>
#include <streambuf>

#include "../common/numbers.hpp"
#endif

namespace openmesh_import {

#ifndef CLARITY_HAVE_OPENMESH

Reading read_om(const Source&, FlatMesh&) {
    throw std::runtime_error(
        "OM files are read by OpenMesh, which was not there when this program was built: install "
        "libopenmesh-dev and build it again");
}

#else

namespace {

constexpr size_t kOmHeaderBytes = 16;

// The bytes of the file as a stream.
class BytesBuffer : public std::streambuf {
 public:
    BytesBuffer(std::string_view bytes, const std::function<void(float)>& progress) : bytes_(bytes), progress_(progress) {
        show(0);
    }

 protected:
    int_type underflow() override {
        if (gptr() == egptr() && !show(next())) return traits_type::eof();
        if (progress_) progress_(static_cast<float>(next()) / static_cast<float>(bytes_.size()));
        return traits_type::to_int_type(*gptr());
    }
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) override {
        const size_t base = from == std::ios_base::beg ? 0 : from == std::ios_base::cur ? next() : bytes_.size();
        return seekpos(static_cast<off_type>(base) + offset, which);
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode) override {
        const off_type at = position;
        if (at < 0 || at > static_cast<off_type>(bytes_.size())) return pos_type(off_type(-1));
        show(static_cast<size_t>(at));
        return position;
    }

 private:
    static constexpr size_t kWindowBytes = 1 << 20;  // between two progress reports
    size_t next() const { return first_ + static_cast<size_t>(gptr() - eback()); }
    // Makes the window around `at` the get area; false at the end.
    bool show(size_t at) {
        first_ = at / kWindowBytes * kWindowBytes;
        const size_t count = std::min(kWindowBytes, bytes_.size() - first_);
        char* const start = const_cast<char*>(bytes_.data()) + first_;  // the get area is never written to
        setg(start, start + (at - first_), start + count);
        return at - first_ < count;
    }
    std::string_view bytes_;
    const std::function<void(float)>& progress_;
    size_t first_ = 0;  // position of the first byte of the get area
};

// Stores properties that the reader has no other place for. The counts tell how many values to make room for.
class PropertyStore : public OpenMesh::BaseKernel {
 public:
    size_t n_vertices() const override { return vertices; }
    size_t n_halfedges() const override { return 2 * edges; }
    size_t n_edges() const override { return edges; }
    size_t n_faces() const override { return faces; }
    size_t vertices = 0, edges = 0, faces = 0;
};

// Receives vertices and faces without OpenMesh's mesh, which cannot hold three faces at one edge.
class OmImporter : public OpenMesh::IO::BaseImporter {
 public:
    using VertexHandle = OpenMesh::VertexHandle;
    using FaceHandle = OpenMesh::FaceHandle;
    using HalfedgeHandle = OpenMesh::HalfedgeHandle;
    using EdgeHandle = OpenMesh::EdgeHandle;
    using Vec2f = OpenMesh::Vec2f;
    using Vec3f = OpenMesh::Vec3f;

    explicit OmImporter(FlatMesh& mesh) : mesh_(mesh) {}
    PropertyStore properties;

    // Call it after reading: OM 2 stores its faces as half-edges.
    void follow_halfedges() {
        // Each half-edge bounds at most one face. So a valid file needs at most as many steps as it has half-edges.
        size_t steps = 0;
        VHandles vertices;
        for (const int start : face_halfedges_) {
            vertices.clear();
            int at = start;
            do {
                if (at < 0 || size_t(at) >= halfedges_.size() || ++steps > halfedges_.size()) {
                    throw std::runtime_error("the half-edges of face " + std::to_string(mesh_.sizes.size()) +
                                             " do not form a loop");
                }
                vertices.push_back(VertexHandle(halfedges_[size_t(at)].to));
                at = halfedges_[size_t(at)].next;
            } while (at != start);
            add_face(vertices);
        }
        face_halfedges_.clear();
    }

    // ---- called by the reader
    VertexHandle add_vertex(const Vec3f& point) override {
        mesh_.add_vertex(point[0], point[1], point[2]);
        return VertexHandle(static_cast<int>(mesh_.vertex_count()) - 1);
    }
    VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
    FaceHandle add_face(const VHandles& vertices) override {
        for (const VertexHandle v : vertices) mesh_.corners.push_back(FlatMesh::vertex_number(v.idx()));
        mesh_.add_face(vertices.size());
        return FaceHandle(static_cast<int>(mesh_.sizes.size()) - 1);
    }
    void set_point(VertexHandle v, const Vec3f& point) override {
        mesh_.set_vertex(size_t(v.idx()), point[0], point[1], point[2]);
    }
    void set_normal(VertexHandle v, const Vec3f& normal) override { set(mesh_.normals, v, normal.data(), 3); }
    void set_normal(VertexHandle v, const OpenMesh::Vec3d& normal) override { set_normal(v, Vec3f(normal)); }
    void set_texcoord(VertexHandle v, const Vec2f& uv) override { set(mesh_.uvs, v, uv.data(), 2); }
    // 3D texture coordinates are ignored; the reader sets 2D ones first.
    void set_texcoord(VertexHandle, const Vec3f&) override {}
    OpenMesh::BaseKernel* kernel() override { return &properties; }
    size_t n_vertices() const override { return mesh_.vertex_count(); }
    size_t n_faces() const override { return mesh_.sizes.size() + face_halfedges_.size(); }
    size_t n_edges() const override { return halfedges_.size() / 2; }
    HalfedgeHandle add_edge(VertexHandle from, VertexHandle to) override {
        const HalfedgeHandle first(static_cast<int>(halfedges_.size()));
        halfedges_.push_back({to.idx(), -1});
        halfedges_.push_back({from.idx(), -1});
        return first;
    }
    FaceHandle add_face(HalfedgeHandle halfedge) override {
        face_halfedges_.push_back(halfedge.idx());
        return FaceHandle(static_cast<int>(face_halfedges_.size()) - 1);
    }
    void set_next(HalfedgeHandle halfedge, HalfedgeHandle next) override {
        if (halfedge.is_valid() && size_t(halfedge.idx()) < halfedges_.size())
            halfedges_[size_t(halfedge.idx())].next = next.idx();
    }
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
    // Later vertices have zeros, until theirs are set.
    void set(std::vector<float>& list, VertexHandle v, const float* values, size_t width) {
        if (!v.is_valid() || size_t(v.idx()) >= mesh_.vertex_count()) return;
        list.resize(width * mesh_.vertex_count());
        std::copy_n(values, width, &list[width * size_t(v.idx())]);
    }

    FlatMesh& mesh_;
    std::vector<Halfedge> halfedges_;
    std::vector<int> face_halfedges_;
};

// Returns false if the reader gave up. The stream throws std::ios_base::failure at the first datum that cannot be read.
bool run_reader(const Source& source, OmImporter& importer) {
    using OpenMesh::IO::Options;
    Options options = Options::VertexNormal | Options::VertexTexCoord;
    omerr().disable();
    omlog().disable();
    BytesBuffer buffer(source.bytes, source.progress);
    std::istream stream(&buffer);
    stream.unsetf(std::ios::skipws);
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    return OpenMesh::IO::IOManager().read(stream, "om", importer, options);
}

}  // namespace

// The header: "OM", 'T' | 'Q' | 'P', version, then the numbers of vertices, faces and edges as 32-bit little-endian integers.
Reading read_om(const Source& source, FlatMesh& mesh) {
    if (source.bytes.size() < kOmHeaderBytes || source.bytes.substr(0, 2) != "OM" || !std::strchr("TQP", source.bytes[2])) {
        throw std::runtime_error("byte 0: not an OM file: its header, 'OM' and the kind of its faces, is not there");
    }
    uint32_t counts[3];
    for (int i = 0; i < 3; ++i) counts[i] = importers::load<uint32_t>(source.bytes.data() + 4 + 4 * i, false);
    const char* const names[3] = {"vertex", "face", "edge"};
    const unsigned least[3] = {12, 1, 1};
    for (int i = 0; i < 3; ++i) {
        const std::string why = too_large(names[i], counts[i], least[i], source.bytes.size() - kOmHeaderBytes);
        if (!why.empty()) throw std::runtime_error(why);
    }
    OmImporter importer(mesh);
    importer.properties.vertices = counts[0];
    importer.properties.faces = counts[1];
    importer.properties.edges = counts[2];
    bool whole = false;
    try {
        whole = run_reader(source, importer);
    } catch (const std::ios_base::failure&) {
        // Files before version 2 have no end mark, and are read until no data is left.
    }
    if (importer.n_vertices() != counts[0] || importer.n_faces() != counts[1] || (counts[1] > 0 && importer.n_faces() == 0)) {
        throw std::runtime_error("has " + std::to_string(importer.n_vertices()) + " of " + std::to_string(counts[0]) +
                                 " vertices and " + std::to_string(importer.n_faces()) + " of " + std::to_string(counts[1]) +
                                 " faces: it is cut off, damaged, or of a newer version");
    }
    importer.follow_halfedges();
    for (auto* list : {&mesh.normals, &mesh.uvs})
        if (!list->empty()) list->resize(mesh.vertex_count() * (list == &mesh.normals ? 3 : 2));
    if (!whole) warn(source, "the file ends early; vertices and faces are complete");
    return {};
}

#endif

}  // namespace openmesh_import
