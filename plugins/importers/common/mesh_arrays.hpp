// mesh_arrays.hpp -- the arrays of a mesh, and vertices that are copied where their corners differ. For importers.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "rt_plugin.hpp"

namespace importers {

// Around points, three numbers each. Those that are not finite do not count.
struct Box {
    template <class T>
    explicit Box(const std::vector<T>& points) {
        for (size_t i = 0; i + 2 < points.size(); i += 3) {
            const T* const p = &points[i];
            if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
            for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], double(p[k])), hi[k] = std::max(hi[k], double(p[k]));
        }
    }
    double size() const { return std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}); }
    double farthest() const {
        double most = 0;
        for (int k = 0; k < 3; ++k) most = std::max({most, std::fabs(lo[k]), std::fabs(hi[k])});
        return most;
    }
    bool is_far() const {
        constexpr double kFar = 16;  // how many times as far from 0 as it is large
        return std::isfinite(farthest()) && farthest() >= kFar * size();
    }
    double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
};

struct MeshArrays {
    // 3, 3, 2 and 4 for each vertex; all but positions may be empty. colors: linear r, g, b, and alpha.
    std::vector<float> positions, normals, uvs, colors;
    std::vector<float> uvs2, tangents;  // 2 and 4, as rt_mesh has them; VertexCopies leaves tangents out
    double origin[3] = {0, 0, 0};       // what was subtracted from positions
    std::vector<rt_u32> sizes;          // corners of each face; empty: all faces are triangles

    // Whether the positions lie so far from 0, as seen by their own size, that floats lose details of them which the file has.
    bool is_far() const { return Box(positions).is_far(); }
    // Sets positions from doubles. If they are far from 0, an origin is subtracted before they are rounded.
    void set_positions(const std::vector<double>& exact) {
        const Box box(exact);
        const double size = box.size();
        if (box.is_far() && size > 0) {
            // A multiple of a power of two as large as the mesh, or so large that floats, as instances have, hold the origin.
            const double grid = std::ldexp(1.0, std::max(std::ilogb(size), std::ilogb(box.farthest()) - 22));
            for (size_t k = 0; k < 3; ++k) origin[k] = std::round((box.lo[k] + box.hi[k]) / 2 / grid) * grid;
        }
        positions.resize(exact.size());
        for (size_t i = 0; i < exact.size(); ++i) positions[i] = static_cast<float>(exact[i] - origin[i % 3]);
    }

    // Passes the mesh and returns the host's id. corners: their vertices. materials: of each face, or one for all.
    rt_u32 pass(const std::string& name, const rt_u32* corners, size_t corner_count, const std::vector<rt_u32>& materials,
                const rt_scene_sink& sink) const {
        rt_mesh out{};
        out.struct_bytes = sizeof out;
        out.name = name.c_str();
        out.positions = positions.data();
        out.vertex_count = static_cast<rt_u32>(positions.size() / 3);
        out.position_stride = out.normal_stride = 3 * sizeof(float);
        out.uv_stride = 2 * sizeof(float);
        std::copy_n(origin, 3, out.origin);
        out.normals = normals.empty() ? nullptr : normals.data();
        out.uvs = uvs.empty() ? nullptr : uvs.data();
        out.colors = colors.empty() ? nullptr : colors.data();
        out.uvs2 = uvs2.empty() ? nullptr : uvs2.data();
        out.uv2_stride = out.uv_stride;
        out.tangents = tangents.empty() ? nullptr : tangents.data();
        out.tangent_stride = 4 * sizeof(float);
        out.color_stride = 4 * sizeof(float);
        out.indices = corners;
        out.index_count = corner_count;
        out.face_sizes = sizes.empty() ? nullptr : sizes.data();
        out.face_count = sizes.empty() ? corner_count / 3 : sizes.size();
        out.material = materials.empty() ? RT_NONE : materials[0];
        const bool differ = std::any_of(materials.begin(), materials.end(), [&](rt_u32 m) { return m != out.material; });
        out.face_materials = differ ? materials.data() : nullptr;
        return rt::id(sink.mesh(sink.ctx, &out));
    }
};

// What a corner has of its own. Values that the mesh has no array for are not read.
struct CornerValues {
    const float *normal = nullptr, *uv = nullptr, *uv2 = nullptr;
    const float* color = nullptr;  // NULL: copies of a vertex have its colour
};

// Gives each corner a vertex with its values: the file's own vertex for the first set of values, and a copy of it for each
// further set.
class VertexCopies {
 public:
    // copy_of: receives the file's vertex of each copy. Copies stand behind the file's vertices.
    VertexCopies(MeshArrays& mesh, bool normals, bool uvs, bool uvs2, bool colors, std::vector<rt_u32>& copy_of)
        : mesh_(mesh), copy_of_(copy_of), next_(mesh.positions.size() / 3), used_(next_.size()) {
        if (normals) mesh.normals.resize(mesh.positions.size());
        if (uvs) mesh.uvs.resize(mesh.positions.size() / 3 * 2);
        if (uvs2) mesh.uvs2.resize(mesh.positions.size() / 3 * 2);
        if (colors) mesh.colors.resize(mesh.positions.size() / 3 * 4, 1.0f);
    }
    rt_u32 vertex(rt_u32 point, const CornerValues& values) {
        if (!used_[point]) {
            used_[point] = true;
            store(point, values);
            return point;
        }
        rt_u32 at = point;
        for (int step = 0;; ++step, at = next_[at]) {
            if (matches(at, values)) return at;
            if (next_[at] == 0 || step == kMaxChain) break;
        }
        const rt_u32 copy = static_cast<rt_u32>(next_.size());
        next_.push_back(next_[at]);
        next_[at] = copy;
        copy_of_.push_back(point);
        for (int k = 0; k < 3; ++k) mesh_.positions.push_back(mesh_.positions[3 * size_t(point) + k]);
        if (!mesh_.normals.empty()) mesh_.normals.resize(mesh_.normals.size() + 3);
        if (!mesh_.uvs.empty()) mesh_.uvs.resize(mesh_.uvs.size() + 2);
        if (!mesh_.uvs2.empty()) mesh_.uvs2.resize(mesh_.uvs2.size() + 2);
        for (size_t k = 0; k < 4 && !mesh_.colors.empty(); ++k) mesh_.colors.push_back(mesh_.colors[4 * size_t(point) + k]);
        store(copy, values);
        return copy;
    }

 private:
    // Values of one vertex that are compared, at most (at the hub of a fan there are many). Beyond, a further copy is made.
    static constexpr int kMaxChain = 32;
    bool matches(rt_u32 at, const CornerValues& v) const {
        return (mesh_.normals.empty() || std::memcmp(&mesh_.normals[3 * size_t(at)], v.normal, 12) == 0) &&
               (mesh_.uvs.empty() || std::memcmp(&mesh_.uvs[2 * size_t(at)], v.uv, 8) == 0) &&
               (mesh_.uvs2.empty() || std::memcmp(&mesh_.uvs2[2 * size_t(at)], v.uv2, 8) == 0) &&
               (!v.color || std::memcmp(&mesh_.colors[4 * size_t(at)], v.color, 16) == 0);
    }
    void store(rt_u32 at, const CornerValues& v) {
        if (!mesh_.normals.empty()) std::copy_n(v.normal, 3, &mesh_.normals[3 * size_t(at)]);
        if (!mesh_.uvs.empty()) std::copy_n(v.uv, 2, &mesh_.uvs[2 * size_t(at)]);
        if (!mesh_.uvs2.empty()) std::copy_n(v.uv2, 2, &mesh_.uvs2[2 * size_t(at)]);
        if (v.color) std::copy_n(v.color, 4, &mesh_.colors[4 * size_t(at)]);
    }
    MeshArrays& mesh_;
    std::vector<rt_u32>& copy_of_;
    std::vector<rt_u32> next_;
    std::vector<bool> used_;
};

// The host's vertices of each vertex of a file: itself, and its copies.
class CopiesOfVertices {
 public:
    // copy_of: the file's vertex of each copy; the copies stand behind the file's `points` vertices.
    CopiesOfVertices(size_t points, const std::vector<rt_u32>& copy_of) : points_(points) {
        for (const rt_u32 vertex : copy_of) copies_.emplace_back(vertex, static_cast<rt_u32>(points + copies_.size()));
        std::sort(copies_.begin(), copies_.end());
    }
    // Calls body(vertex) for each; for none, if the file has no such vertex.
    template <class Body>
    void each(int64_t vertex, const Body& body) const {
        if (vertex < 0 || static_cast<uint64_t>(vertex) >= points_) return;
        const rt_u32 v = static_cast<rt_u32>(vertex);
        body(v);
        auto at = std::lower_bound(copies_.begin(), copies_.end(), std::make_pair(v, rt_u32(0)));
        for (; at != copies_.end() && at->first == v; ++at) body(at->second);
    }

 private:
    size_t points_;
    std::vector<std::pair<rt_u32, rt_u32>> copies_;
};

}  // namespace importers
