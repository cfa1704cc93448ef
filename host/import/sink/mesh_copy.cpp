#include "import/sink/mesh_copy.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "scene/material_keys.hpp"
#include "scene/tangents.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

constexpr uint64_t kMaxVertices = RT_NONE - 1;

Problem check_description(const rt_mesh& m) {
    const auto bad_stride = [](rt_u32 stride, rt_u32 least) { return stride < least || stride % 4 != 0; };
    if (m.vertex_count > 0) {
        if (!m.positions) return "it has vertices but no positions";
        if (bad_stride(m.position_stride, 12)) return "position_stride " + std::to_string(m.position_stride);
        if (m.normals && bad_stride(m.normal_stride, 12)) return "normal_stride " + std::to_string(m.normal_stride);
        if (m.uvs && bad_stride(m.uv_stride, 8)) return "uv_stride " + std::to_string(m.uv_stride);
        if (m.uvs2 && bad_stride(m.uv2_stride, 8)) return "uv2_stride " + std::to_string(m.uv2_stride);
        if (m.tangents && bad_stride(m.tangent_stride, 16)) return "tangent_stride " + std::to_string(m.tangent_stride);
        if (m.colors && bad_stride(m.color_stride, 16)) return "color_stride " + std::to_string(m.color_stride);
    }
    if (m.index_count > 0 && !m.indices) return "it has faces but no indices";
    // Every corner and every face takes 4 bytes of the plugin's memory, so a larger number is a wrong count.
    if (m.index_count > uint64_t(1) << 40 || m.face_count > uint64_t(1) << 40) {
        return std::to_string(std::max(m.index_count, m.face_count)) + " indices or faces are absurd";
    }
    if (!m.face_sizes && m.index_count != 3 * m.face_count) {
        return std::to_string(m.index_count) + " indices are not three for each of " + std::to_string(m.face_count) +
               " triangles";
    }
    if (m.face_sizes) {
        uint64_t sum = 0;
        for (uint64_t i = 0; i < m.face_count; ++i) sum += m.face_sizes[i];
        if (sum != m.index_count) {
            return "its faces have " + std::to_string(sum) + " corners, but there are " + std::to_string(m.index_count) +
                   " indices";
        }
    }
    return {};
}

// Copies `width` floats per element. Returns false if one of them is not usable.
bool copy_strided(const float* from, rt_u32 stride, rt_u32 count, rt_u32 width, float* to) {
    if (stride == 4 * width) {
        std::memcpy(to, from, size_t(count) * stride);
    } else {
        const char* source = reinterpret_cast<const char*>(from);
        for (rt_u32 i = 0; i < count; ++i, source += stride, to += width) std::memcpy(to, source, 4 * width);
        to -= size_t(width) * count;
    }
    bool good = true;
    for (size_t i = 0; i < size_t(count) * width; ++i) good &= is_usable(to[i]);
    return good;
}

// A scene has normals, uvs and colours either for all vertices or for none: meshes without them, and elements that are not
// usable, get `none`. reserved: numbers for which the array of positions has space.
void copy_attribute(const float* from, rt_u32 stride, rt_u32 first, rt_u32 count, rt_u32 width, float none, size_t reserved,
                    std::vector<float>& to) {
    if (!from && to.empty()) return;
    to.reserve(reserved / 3 * width);
    to.resize(size_t(width) * (size_t(first) + count), none);
    if (!from || count == 0) return;
    float* values = to.data() + size_t(width) * first;
    if (copy_strided(from, stride, count, width, values)) return;
    for (rt_u32 i = 0; i < count; ++i, values += width) {
        if (!are_usable(values, width)) std::fill(values, values + width, none);
    }
}

// Brings colours into the range of a material's color and opacity: files of no meaning have others.
void limit_colors(rt_u32 first_vertex, SharedArray<float>& colors) {
    const Key& key = material_key("color");
    const auto most = static_cast<float>(key.max);
    const size_t first = 4 * size_t(first_vertex);
    const auto limit = [&](size_t i) { return std::clamp(colors[i], 0.f, i % 4 == 3 ? 1.f : most); };
    for (size_t i = first; i < colors.size(); ++i)
        if (colors[i] != limit(i)) colors.own()[i] = limit(i);
}

// Maps the material ids of a mesh's faces to scene materials.
class FaceMaterials {
 public:
    FaceMaterials(const rt_mesh& mesh, const std::vector<rt_u32>& known) : mesh_(mesh), known_(known) {}
    Problem check() const {
        if (!valid(mesh_.material)) return unknown(mesh_.material);
        for (uint64_t i = 0; mesh_.face_materials && i < mesh_.face_count; ++i) {
            if (!valid(mesh_.face_materials[i])) return "face " + std::to_string(i) + ": " + unknown(mesh_.face_materials[i]);
        }
        return {};
    }
    bool same_for_all() const { return !mesh_.face_materials; }
    rt_u32 of(uint64_t face) const {
        const rt_u32 id = mesh_.face_materials ? mesh_.face_materials[face] : mesh_.material;
        return id == RT_NONE ? 0 : known_[id];
    }

 private:
    bool valid(rt_u32 id) const { return id == RT_NONE || id < known_.size(); }
    std::string unknown(rt_u32 id) const {
        return "material id " + std::to_string(id) + " of " + std::to_string(known_.size()) +
               " is unknown: pass an id that the sink returned";
    }
    const rt_mesh& mesh_;
    const std::vector<rt_u32>& known_;
};

constexpr const char* kTooManyTriangles = "more than 268435455 triangles in all, which is what a scene can hold";

// Fast path for the common case of large scans: all faces are sound triangles. It copies at the speed of memory. Returns false
// if the mesh needs the general path.
bool copy_all_triangles(const rt_mesh& m, rt_u32 first_vertex, const FaceMaterials& materials, Scene& scene) {
    if (m.face_count == 0) return true;
    rt_u32 highest = 0;
    for (uint64_t i = 0; i < m.index_count; ++i) highest = std::max(highest, m.indices[i]);
    if (highest >= m.vertex_count) return false;
    const size_t before = scene.triangles.size();
    std::vector<rt_u32>&triangles = scene.triangles.own(), &triangle_materials = scene.triangle_materials.own();
    triangles.resize(before + m.index_count);
    for (uint64_t i = 0; i < m.index_count; ++i) triangles[before + i] = m.indices[i] + first_vertex;
    triangle_materials.resize(triangles.size() / 3, materials.of(0));
    for (uint64_t i = 0; !materials.same_for_all() && i < m.face_count; ++i) {
        triangle_materials[before / 3 + i] = materials.of(i);
    }
    return true;
}

Problem copy_faces(const rt_mesh& m, rt_u32 first_vertex, const std::vector<bool>& unusable, const FaceMaterials& materials,
                   Scene& scene, Triangulator& triangulator, FaceCount& faces) {
    const float* positions = scene.positions.data() + 3 * size_t(first_vertex);
    std::vector<rt_u32>&out = scene.triangles.own(), &triangle_materials = scene.triangle_materials.own();
    const rt_u32* corners = m.indices;
    for (uint64_t face = 0; face < m.face_count; ++face) {
        const rt_u32 size = m.face_sizes ? m.face_sizes[face] : 3;
        const rt_u32* begin = corners;
        corners += size;
        if (size < 3) continue;  // a point or a line
        ++faces.all;
        if (std::any_of(begin, corners, [&](rt_u32 v) { return v >= m.vertex_count; })) {
            ++faces.out_of_range;
            continue;
        }
        if (!unusable.empty() && std::any_of(begin, corners, [&](rt_u32 v) { return unusable[v]; })) {
            ++faces.not_finite;
            continue;
        }
        const size_t before = out.size();
        triangulator.add(positions, begin, size, out);
        if (out.size() / 3 > RT_REF_INDEX_MAX) return kTooManyTriangles;
        for (size_t i = before; i < out.size(); ++i) out[i] += first_vertex;
        triangle_materials.resize(out.size() / 3, materials.of(face));
        ++scene.meshes.back().polygon_count;
    }
    return {};
}

}  // namespace

Problem copy_mesh(const rt_mesh& m, const std::vector<rt_u32>& known, Scene& scene, Triangulator& triangulator,
                  FaceCount& faces) {
    if (Problem why = check_description(m)) return why;
    const FaceMaterials materials(m, known);
    if (Problem why = materials.check()) return why;
    const rt_u32 first_vertex = scene.vertex_count();
    if (uint64_t(first_vertex) + m.vertex_count > kMaxVertices) return "more than 4294967294 vertices in all";
    if (scene.triangle_count() + (m.face_sizes ? 0 : m.face_count) > RT_REF_INDEX_MAX) return kTooManyTriangles;

    std::vector<float>& all_positions = scene.positions.own();
    all_positions.resize(3 * (size_t(first_vertex) + m.vertex_count));
    float* positions = all_positions.data() + 3 * size_t(first_vertex);
    std::vector<bool> unusable;
    if (m.vertex_count > 0 && !copy_strided(m.positions, m.position_stride, m.vertex_count, 3, positions)) {
        unusable.resize(m.vertex_count, false);
        for (rt_u32 i = 0; i < m.vertex_count; ++i, positions += 3) {
            unusable[i] = !are_usable(positions, 3);
            if (unusable[i]) std::fill(positions, positions + 3, 0.f);
        }
    }
    const size_t reserved = all_positions.capacity();
    copy_attribute(m.normals, m.normal_stride, first_vertex, m.vertex_count, 3, 0, reserved, scene.normals.own());
    copy_attribute(m.uvs, m.uv_stride, first_vertex, m.vertex_count, 2, 0, reserved, scene.uvs.own());
    copy_attribute(m.uvs2, m.uv2_stride, first_vertex, m.vertex_count, 2, 0, reserved, scene.uvs2.own());
    copy_attribute(m.colors, m.color_stride, first_vertex, m.vertex_count, 4, 1, reserved, scene.colors.own());
    limit_colors(first_vertex, scene.colors);

    Problem why;
    Mesh mesh;
    mesh.name = m.name ? m.name : "";
    mesh.first_vertex = first_vertex;
    mesh.vertex_count = m.vertex_count;
    mesh.first_triangle = scene.triangle_count();
    scene.meshes.push_back(std::move(mesh));
    Mesh& added = scene.meshes.back();
    if (!m.face_sizes && unusable.empty() && copy_all_triangles(m, first_vertex, materials, scene)) {
        faces.all += m.face_count;
        added.polygon_count = static_cast<rt_u32>(m.face_count);
    } else {
        why = copy_faces(m, first_vertex, unusable, materials, scene, triangulator, faces);
    }
    added.triangle_count = scene.triangle_count() - added.first_triangle;
    if (m.tangents && !why) {
        std::vector<float> tangents(4 * size_t(m.vertex_count));
        copy_strided(m.tangents, m.tangent_stride, m.vertex_count, 4, tangents.data());
        scene.tangents.resize(scene.triangles.size(), 0);
        for (rt_u32 i = 0; i < added.triangle_count; ++i)
            store_tangents(scene, added.first_triangle + i, tangents, first_vertex);
    }
    return why;
}

}  // namespace clarity::import
