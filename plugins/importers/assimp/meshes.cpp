#include "meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "rt_plugin.hpp"

namespace assimp_import {
namespace {

// Position, normal, two sets of uv. Vertices are compared bit by bit.
using Vertex = std::array<float, 10>;

// Gives equal vertices the same index: a hash table with open addressing over the list of vertices.
class VertexSet {
 public:
    explicit VertexSet(size_t expected) {
        size_t slots = 64;
        while (slots < 2 * expected) slots *= 2;
        slots_.assign(slots, RT_NONE);
        vertices.reserve(expected / 2);
    }
    rt_u32 add(const Vertex& vertex) {
        size_t slot = hash(vertex) & (slots_.size() - 1);
        while (slots_[slot] != RT_NONE) {
            if (std::memcmp(&vertices[slots_[slot]], &vertex, sizeof vertex) == 0) return slots_[slot];
            slot = (slot + 1) & (slots_.size() - 1);
        }
        slots_[slot] = static_cast<rt_u32>(vertices.size());
        vertices.push_back(vertex);
        return slots_[slot];
    }
    std::vector<Vertex> vertices;

 private:
    static size_t hash(const Vertex& vertex) {
        uint64_t words[5], h = 0;
        std::memcpy(words, &vertex, sizeof words);
        for (const uint64_t word : words) {
            h = (h ^ word) * 0x9E3779B97F4A7C15u;
            h ^= h >> 32;
        }
        return h;
    }
    std::vector<rt_u32> slots_;
};

bool is_finite(const aiVector3D& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

class CornerReader {
 public:
    CornerReader(const aiMesh& mesh, const Channels& channels) : mesh_(mesh) {
        for (size_t k = 0; k < channels.size(); ++k)
            uvs_[k] = mesh.mTextureCoords[channels[k]] ? mesh.mTextureCoords[channels[k]] : mesh.mTextureCoords[0];
        has_uvs2_ = channels[0] != channels[1];
    }
    bool has_uvs() const { return uvs_[0] != nullptr; }
    bool has_uvs2() const { return has_uvs2_ && uvs_[1]; }
    Vertex read(unsigned index) const {
        Vertex vertex{};
        const auto put = [&](size_t at, float x) { vertex[at] = std::isfinite(x) ? x + 0.0f : 0; };  // -0 + 0 is +0
        const aiVector3D& p = mesh_.mVertices[index];
        for (unsigned k = 0; k < 3; ++k) put(k, p[k]);
        if (mesh_.mNormals && is_finite(mesh_.mNormals[index])) {
            for (unsigned k = 0; k < 3; ++k) put(3 + k, mesh_.mNormals[index][k]);
        }
        for (size_t k = 0; k < (has_uvs2() ? 2 : 1); ++k) {
            if (!uvs_[k]) continue;
            put(6 + 2 * k, uvs_[k][index].x);
            put(7 + 2 * k, uvs_[k][index].y);
        }
        return vertex;
    }

 private:
    const aiMesh& mesh_;
    const aiVector3D* uvs_[2] = {};
    bool has_uvs2_ = false;
};

// True if all indices of the face are in range and its vertices are finite.
bool is_sound(const aiMesh& mesh, const aiFace& face) {
    for (unsigned i = 0; i < face.mNumIndices; ++i) {
        if (face.mIndices[i] >= mesh.mNumVertices || !is_finite(mesh.mVertices[face.mIndices[i]])) return false;
    }
    return true;
}

Transform from_assimp(const aiMatrix4x4& m) {
    return {m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4};
}

}  // namespace

rt_u32 MeshTable::id(const aiNode& node) {
    std::vector<Part> parts;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const unsigned mesh = node.mMeshes[i];
        if (mesh >= scene_.mNumMeshes || !scene_.mMeshes[mesh] || !scene_.mMeshes[mesh]->mVertices) continue;
        parts.push_back({mesh, scene_.mMeshes[mesh]->mMaterialIndex});
    }
    if (parts.empty()) return RT_NONE;
    const auto known = ids_.find(parts);
    if (known != ids_.end()) return known->second;
    const aiString& name = scene_.mMeshes[parts[0].first]->mName;
    return ids_[parts] = add(parts, name.length > 0 ? name.C_Str() : node.mName.C_Str());
}

rt_u32 MeshTable::add(const std::vector<Part>& parts, const char* name) {
    size_t corner_count = 0;
    for (const Part& part : parts) corner_count += scene_.mMeshes[part.first]->mNumVertices;
    VertexSet set(corner_count);
    std::vector<rt_u32> indices, sizes, materials;
    bool has_normals = false, has_uvs = false, has_uvs2 = false, all_triangles = true;
    for (const auto& [index_of_mesh, index_of_material] : parts) {
        const aiMesh& mesh = *scene_.mMeshes[index_of_mesh];
        const CornerReader corners(mesh, materials_.channels(index_of_material));
        rt_u32 material = RT_NONE;
        bool is_used = false;
        std::vector<rt_u32> seen(mesh.mNumVertices, RT_NONE);
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices < 3) {
                ++points_and_lines_;
                continue;
            }
            if (!is_sound(mesh, face)) {
                ++broken_faces_;
                continue;
            }
            if (!is_used) material = materials_.id(index_of_material);
            is_used = true;
            for (unsigned i = 0; i < face.mNumIndices; ++i) {
                rt_u32& index = seen[face.mIndices[i]];
                if (index == RT_NONE) index = set.add(corners.read(face.mIndices[i]));
                indices.push_back(index);
            }
            sizes.push_back(face.mNumIndices);
            materials.push_back(material);
            all_triangles = all_triangles && face.mNumIndices == 3;
        }
        if (is_used) {
            has_normals = has_normals || mesh.mNormals;
            has_uvs = has_uvs || corners.has_uvs();
            has_uvs2 = has_uvs2 || corners.has_uvs2();
            colored_ += mesh.mColors[0] != nullptr;
        }
    }
    if (sizes.empty()) return RT_NONE;
    faces_ += sizes.size();

    rt_mesh out{};
    out.struct_bytes = sizeof out;
    out.name = name;
    out.positions = set.vertices[0].data();
    out.vertex_count = static_cast<rt_u32>(set.vertices.size());
    out.position_stride = out.normal_stride = out.uv_stride = out.uv2_stride = sizeof(Vertex);
    if (has_normals) out.normals = set.vertices[0].data() + 3;
    if (has_uvs) out.uvs = set.vertices[0].data() + 6;
    if (has_uvs2) out.uvs2 = set.vertices[0].data() + 8;
    out.indices = indices.data();
    out.index_count = indices.size();
    if (!all_triangles) out.face_sizes = sizes.data();
    out.face_count = sizes.size();
    out.material = materials[0];
    if (std::any_of(materials.begin(), materials.end(), [&](rt_u32 m) { return m != materials[0]; })) {
        out.face_materials = materials.data();
    }
    return rt::id(sink_.mesh(sink_.ctx, &out));
}

std::array<double, 3> transform_vector(const Transform& m, const aiVector3D& v) {
    std::array<double, 3> r{};
    for (int row = 0; row < 3; ++row) r[row] = m[4 * row] * v.x + m[4 * row + 1] * v.y + m[4 * row + 2] * v.z;
    return r;
}

std::array<double, 3> transform_point(const Transform& m, const aiVector3D& p) {
    std::array<double, 3> r = transform_vector(m, p);
    for (int row = 0; row < 3; ++row) r[row] += m[4 * row + 3];
    return r;
}

NodeTree::NodeTree(const aiScene& scene) {
    struct Pending {
        const aiNode* node;
        Transform parent;  // inherited by the node
    };
    std::vector<Pending> stack;
    if (scene.mRootNode) stack.push_back({scene.mRootNode, kIdentity});
    while (!stack.empty()) {
        const Pending at = stack.back();
        stack.pop_back();
        nodes_.push_back({at.node, multiply(at.parent, from_assimp(at.node->mTransformation))});
        const Transform world = nodes_.back().world;
        // The children go onto the stack in reverse, so that siblings come out in the order of the file.
        for (unsigned i = at.node->mNumChildren; i > 0; --i) {
            if (const aiNode* child = at.node->mChildren[i - 1]) stack.push_back({child, world});
        }
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
        by_name_[std::string(nodes_[i].node->mName.data, nodes_[i].node->mName.length)].push_back(i);
    }
}

const PlacedNode* NodeTree::find(const std::string& name, size_t n) const {
    const auto found = by_name_.find(name);
    if (found == by_name_.end()) return nullptr;
    return &nodes_[found->second[std::min(n, found->second.size() - 1)]];
}

}  // namespace assimp_import
