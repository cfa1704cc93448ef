#include <algorithm>
#include <cmath>
#include <cstring>

#include "layers.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

// A geometry in the form that the host takes.
struct MeshData {
    std::vector<float> positions, normals, uvs;
    std::vector<rt_u32> indices, sizes;  // no sizes: all faces are triangles
    size_t faces = 0, points = 0;
    std::vector<int32_t> slots;
    std::vector<uint32_t> copy_of;
};

// PolygonVertexIndex lists corners; the last one of a face is written as -1 - index. Source: Blender developer blog. `indices`
// gets the indices themselves.
void read_faces(std::vector<int32_t> corners, MeshData& out) {
    bool all_triangles = corners.size() % 3 == 0;
    for (size_t i = 0; all_triangles && i < corners.size(); i += 3) {
        all_triangles = corners[i] >= 0 && corners[i + 1] >= 0 && corners[i + 2] < 0;
    }
    out.indices.resize(corners.size());
    rt_u32 size = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const int32_t c = corners[i];
        out.indices[i] = static_cast<rt_u32>(c < 0 ? ~c : c);
        ++size;
        if (!all_triangles && (c < 0 || i + 1 == corners.size())) {
            out.sizes.push_back(size);
            size = 0;
        }
    }
    out.faces = all_triangles ? corners.size() / 3 : out.sizes.size();
}

// Gives each corner a vertex with its normal and uv: the file's own vertex for the first set of values, a copy for each further
// one.
class VertexCopies {
 public:
    VertexCopies(MeshData& mesh, bool normals, bool uvs) : mesh_(mesh), next_(mesh.points, 0), used_(mesh.points) {
        if (normals) mesh.normals.resize(3 * mesh.points);
        if (uvs) mesh.uvs.resize(2 * mesh.points);
    }
    rt_u32 vertex(rt_u32 point, const float* normal, const float* uv) {
        if (!used_[point]) {
            used_[point] = true;
            store(point, normal, uv);
            return point;
        }
        rt_u32 at = point;
        for (int step = 0;; ++step, at = next_[at]) {
            if (matches(at, normal, uv)) return at;
            if (next_[at] == 0 || step == kMaxChain) break;
        }
        const rt_u32 copy = static_cast<rt_u32>(next_.size());
        next_.push_back(next_[at]);
        next_[at] = copy;
        mesh_.copy_of.push_back(point);
        for (int k = 0; k < 3; ++k) mesh_.positions.push_back(mesh_.positions[3 * size_t(point) + k]);
        if (!mesh_.normals.empty()) mesh_.normals.resize(mesh_.normals.size() + 3);
        if (!mesh_.uvs.empty()) mesh_.uvs.resize(mesh_.uvs.size() + 2);
        store(copy, normal, uv);
        return copy;
    }

 private:
    // Values of one vertex that are compared, at most (at the hub of a fan there are many). Beyond, a further copy is made.
    static constexpr int kMaxChain = 32;
    bool matches(rt_u32 at, const float* normal, const float* uv) const {
        return (mesh_.normals.empty() || std::memcmp(&mesh_.normals[3 * size_t(at)], normal, 12) == 0) &&
               (mesh_.uvs.empty() || std::memcmp(&mesh_.uvs[2 * size_t(at)], uv, 8) == 0);
    }
    void store(rt_u32 at, const float* normal, const float* uv) {
        if (!mesh_.normals.empty()) std::copy_n(normal, 3, &mesh_.normals[3 * size_t(at)]);
        if (!mesh_.uvs.empty()) std::copy_n(uv, 2, &mesh_.uvs[2 * size_t(at)]);
    }
    MeshData& mesh_;
    std::vector<rt_u32> next_;
    std::vector<bool> used_;
};

// Calls body(corner) for each corner whose vertex exists.
template <class Body>
void for_corners(MeshData& mesh, const Body& body) {
    Corner c{0, 0, 0};
    size_t left = mesh.sizes.empty() ? 3 : mesh.sizes[0];
    for (; c.corner < mesh.indices.size(); ++c.corner) {
        c.vertex = mesh.indices[c.corner];
        if (c.vertex < mesh.points) body(c);
        if (--left > 0) continue;
        ++c.face;
        left = mesh.sizes.empty() || c.face >= mesh.sizes.size() ? 3 : mesh.sizes[c.face];
    }
}

void read_layers(const Document& document, const Node& geometry, MeshData& mesh) {
    const MeshCounts counts = {mesh.indices.size(), mesh.points, mesh.faces};
    Layer normals(document, geometry, "LayerElementNormal", "Normals", "NormalsIndex", 3, counts);
    Layer uvs(document, geometry, "LayerElementUV", "UV", "UVIndex", 2, counts);
    if (normals.empty()) normals = Layer::of_list(document.numbers<float>(&geometry, "Normals"), 3, counts);  // up to 5.8
    if (const Node* info = document.child(&geometry, "GeometryUVInfo"); info && uvs.empty()) {                // up to 5.8
        uvs = Layer::of_indices(document.numbers<float>(info, "TextureUV"), 2,
                                document.numbers<int32_t>(info, "TextureUVVerticeIndex"));
    }
    if (normals.empty() && uvs.empty()) return;
    static constexpr float zeros[3] = {};
    VertexCopies copies(mesh, !normals.empty(), !uvs.empty());
    const auto or_zero = [](const float* values) { return values ? values : zeros; };
    for_corners(mesh, [&](const Corner& c) {
        mesh.indices[c.corner] = copies.vertex(static_cast<rt_u32>(c.vertex), or_zero(normals.at(c)), or_zero(uvs.at(c)));
    });
}

MeshData read_mesh(const Document& document, const Node& geometry) {
    MeshData mesh;
    mesh.positions = document.numbers<float>(&geometry, "Vertices");
    mesh.points = mesh.positions.size() / 3;
    mesh.positions.resize(3 * mesh.points);
    if (mesh.points >= RT_NONE / 2) throw Broken(document.place(geometry) + ": there are more vertices than a mesh can have");
    read_faces(document.numbers<int32_t>(&geometry, "PolygonVertexIndex"), mesh);
    mesh.slots = material_slots(document, geometry, mesh.faces);
    read_layers(document, geometry, mesh);
    return mesh;
}

// A mesh to show: a geometry with the materials that its first node gives it.
struct Wanted {
    uint32_t object, node;
    const Node* geometry;
    std::vector<const Node*> materials;
};

std::vector<rt_u32> face_materials(const MeshData& mesh, const std::vector<rt_u32>& ids) {
    std::vector<rt_u32> out;
    for (const int32_t slot : mesh.slots)
        out.push_back(static_cast<size_t>(slot) < ids.size() ? ids[static_cast<size_t>(slot)] : RT_NONE);
    return out;
}

SceneMesh pass(const Context& context, const Wanted& wanted, MeshData& mesh, const std::vector<rt_u32>& ids,
               const std::string& name) {
    rt_mesh out{};
    out.struct_bytes = sizeof out;
    out.name = name.c_str();
    out.positions = mesh.positions.data();
    out.vertex_count = static_cast<rt_u32>(mesh.positions.size() / 3);
    out.position_stride = out.normal_stride = 12;
    out.uv_stride = 8;
    out.normals = mesh.normals.empty() ? nullptr : mesh.normals.data();
    out.uvs = mesh.uvs.empty() ? nullptr : mesh.uvs.data();
    out.indices = mesh.indices.data();
    out.index_count = mesh.indices.size();
    out.face_sizes = mesh.sizes.empty() ? nullptr : mesh.sizes.data();
    out.face_count = mesh.faces;
    const std::vector<rt_u32> materials = face_materials(mesh, ids);
    out.material = ids.empty() ? RT_NONE : ids[0];
    out.face_materials = materials.empty() ? nullptr : materials.data();
    SceneMesh added;
    added.id = rt::id(context.sink.mesh(context.sink.ctx, &out));
    added.object = wanted.object;
    added.node = wanted.node;
    added.points = static_cast<uint32_t>(mesh.points);
    added.copy_of = std::move(mesh.copy_of);
    return added;
}

// The meshes that a node shows. From version 7 on they hang from the model; before, they are part of it.
std::vector<uint32_t> meshes_of(const Context& context, uint32_t model) {
    std::vector<uint32_t> out;
    for (const uint32_t geometry : context.objects.below(model, "Geometry", "Mesh")) {
        if (context.document.child(context.objects[geometry].node, "Vertices")) out.push_back(geometry);
    }
    const Node* own = context.objects[model].node;
    if (context.document.child(own, "Vertices") && context.document.child(own, "GeometryVersion")) out.push_back(model);
    return out;
}

void show(const Context& context, const SceneNode& node, rt_u32 mesh) {
    const Transform& into_node = node.transform.geometry;
    rt_instance_desc out = rt::instance(mesh, context.objects[node.object].name.c_str());
    std::transform(into_node.begin(), into_node.end(), out.world_from_object, [](double x) { return static_cast<float>(x); });
    out.node = node.id;
    rt::id(context.sink.instance(context.sink.ctx, &out));
}

// Bytes of geometry that are decoded at the same time, about.
constexpr size_t kBatchBytes = 48u << 20;

size_t bytes_of(const Document& document, const Node& geometry) {
    size_t bytes = 0;
    for (const char* name : {"Vertices", "PolygonVertexIndex"}) {
        const Node* node = document.child(&geometry, name);
        const Node* inner = node && !document.is_binary() ? document.child(node, "a") : nullptr;
        if (node) bytes += (inner ? inner : node)->values.size();
    }
    return bytes;
}

}  // namespace

std::vector<SceneMesh> add_meshes(const Context& context, const std::vector<SceneNode>& nodes) {
    Materials materials(context);
    // Nodes that give the same geometry other materials get a mesh of their own.
    std::map<std::pair<const Node*, std::vector<const Node*>>, size_t> known;
    std::vector<Wanted> wanted;
    std::vector<std::pair<uint32_t, size_t>> shown;  // node, number in `wanted`
    for (uint32_t n = 0; n < nodes.size(); ++n) {
        for (const uint32_t object : meshes_of(context, nodes[n].object)) {
            const Node* geometry = context.objects[object].node;
            const std::vector<const Node*> slots = materials.of(nodes[n].object);
            const auto [at, is_new] = known.emplace(std::make_pair(geometry, slots), wanted.size());
            if (is_new) wanted.push_back({object, n, geometry, slots});
            shown.push_back({n, at->second});
        }
    }
    std::vector<SceneMesh> meshes;
    for (size_t first = 0; first < wanted.size();) {
        size_t end = first, bytes = 0;
        while (end < wanted.size() && end - first < 256 && bytes < kBatchBytes) {
            bytes += bytes_of(context.document, *wanted[end++].geometry);
        }
        std::vector<MeshData> data(end - first);
        rt::parallel_for(context.host, static_cast<rt_u32>(data.size()),
                         [&](rt_u32 i) { data[i] = read_mesh(context.document, *wanted[first + i].geometry); });
        for (size_t i = first; i < end; ++i) {
            const Wanted& w = wanted[i];
            std::vector<rt_u32> ids;
            for (const Node* material : w.materials) ids.push_back(materials.id(material, nodes[w.node].object));
            const std::string& own = context.objects[w.object].name;
            meshes.push_back(
                pass(context, w, data[i - first], ids, own.empty() ? context.objects[nodes[w.node].object].name : own));
            data[i - first] = MeshData();
        }
        first = end;
        context.file.forget();
        rt::progress(context.host, 0.1f + 0.8f * static_cast<float>(first) / static_cast<float>(wanted.size()));
    }
    for (const auto& [node, mesh] : shown) show(context, nodes[node], meshes[mesh].id);
    return meshes;
}

}  // namespace fbx_import
