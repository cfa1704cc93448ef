#include <algorithm>
#include <array>

#include "../common/mesh_arrays.hpp"
#include "../common/numbers.hpp"
#include "layers.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

// A geometry in the form that the host takes.
struct MeshData : importers::MeshArrays {
    std::vector<int32_t> indices;  // numbers below 0 name no vertex
    size_t points = 0;
    size_t faces() const { return sizes.empty() ? indices.size() / 3 : sizes.size(); }
    std::vector<int32_t> slots;
    std::vector<uint32_t> copy_of;
};

// PolygonVertexIndex lists corners; the last one of a face is written as -1 - index. Source: Blender developer blog.
void read_faces(MeshData& mesh) {
    std::vector<int32_t>& corners = mesh.indices;
    mesh.sizes.reserve(corners.size() / 3);
    rt_u32 size = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        ++size;
        if (corners[i] >= 0 && i + 1 < corners.size()) continue;
        mesh.sizes.push_back(size);
        size = 0;
        corners[i] = corners[i] < 0 ? ~corners[i] : corners[i];
    }
    if (std::all_of(mesh.sizes.begin(), mesh.sizes.end(), [](rt_u32 corner_count) { return corner_count == 3; }))
        std::vector<rt_u32>().swap(mesh.sizes);
}

// A mesh to show: a geometry with the materials that its first node gives it.
struct Wanted {
    uint32_t object, node;
    const Node* geometry;
    std::vector<uint32_t> materials;
    std::vector<UvSets> uv_sets;  // of each material
};

// The sets of texture coordinates that the materials need: the first one, and those that textures name. of_slot: which of them
// each material has as its first and its second.
std::vector<const Node*> uv_layers(const Document& document, const Wanted& wanted,
                                   std::vector<std::array<size_t, kMostUvSets>>& of_slot) {
    std::vector<const Node*> out(1, document.child(wanted.geometry, "LayerElementUV"));
    for (const UvSets& sets : wanted.uv_sets) {
        std::array<size_t, kMostUvSets>& to = of_slot.emplace_back();
        for (size_t k = 0; k < sets.size(); ++k) {
            const Node* found = out[0];
            for (const Node& layer : document.children(*wanted.geometry)) {
                const bool is_set = layer.name == "LayerElementUV" && !sets[k].empty();
                if (is_set && document.text(&layer, "Name") == sets[k]) found = &layer;
            }
            const auto at = std::find(out.begin(), out.end(), found);
            to[k] = static_cast<size_t>(at - out.begin());
            if (at == out.end()) out.push_back(found);
        }
    }
    return out;
}

Layer read_normals(const Document& document, const Node& geometry) {
    Layer normals(document, document.child(&geometry, "LayerElementNormal"), "Normals", "NormalsIndex", 3);
    // Up to version 5.8 the numbers stand in the model.
    return normals.empty() ? Layer(Layer::unknown, 3, document.numbers<float>(&geometry, "Normals")) : std::move(normals);
}

Layer read_uvs(const Document& document, const Node& geometry, const Node* layer) {
    const Node* info = document.child(&geometry, "GeometryUVInfo");  // up to version 5.8
    if (layer || !info) return Layer(document, layer, "UV", "UVIndex", 2);
    return Layer(Layer::by_corner, 2, document.numbers<float>(info, "TextureUV"),
                 document.numbers<int32_t>(info, "TextureUVVerticeIndex"));
}

// r, g, b and alpha. The format does not say in which space they are; Maya and 3ds Max have them as shown on the screen, and
// Blender and three.js read them as sRGB.
Layer read_colors(const Document& document, const Node& geometry) {
    return Layer(document, document.child(&geometry, "LayerElementColor"), "Colors", "ColorIndex", 4);
}
std::array<float, 4> linear_color(const Layer& colors, const Corner& corner) {
    static constexpr float ones[4] = {1, 1, 1, 1};
    const float* const c = colors.at(corner, ones);
    return {importers::linear_of_srgb(c[0]), importers::linear_of_srgb(c[1]), importers::linear_of_srgb(c[2]), c[3]};
}

MeshData read_mesh(const Context& context, const Wanted& wanted) {
    const Document& document = context.document;
    const Node& geometry = *wanted.geometry;
    MeshData mesh;
    Layer normals, colors;
    std::vector<std::array<size_t, kMostUvSets>> uv_of_slot;
    const std::vector<const Node*> layers = uv_layers(document, wanted, uv_of_slot);
    std::vector<Layer> uvs(layers.size());
    // Most of the time is spent on the arrays, which can be inflated at the same time.
    rt::parallel_for(context.host, static_cast<rt_u32>(4 + uvs.size()), [&](rt_u32 i) {
        if (i == 0) mesh.indices = document.numbers<int32_t>(&geometry, "PolygonVertexIndex");
        if (i == 1) {
            mesh.positions = document.numbers<float>(&geometry, "Vertices");
            if (mesh.is_far()) mesh.set_positions(document.numbers<double>(&geometry, "Vertices"));
        }
        if (i == 2) normals = read_normals(document, geometry);
        if (i == 3) colors = read_colors(document, geometry);
        if (i > 3) uvs[i - 4] = read_uvs(document, geometry, layers[i - 4]);
    });
    mesh.points = mesh.positions.size() / 3;
    mesh.positions.resize(3 * mesh.points);
    if (mesh.points >= RT_NONE / 2) document.fail(geometry, "there are more vertices than a mesh can have");
    read_faces(mesh);
    mesh.slots = material_slots(document, geometry, mesh.faces());
    const MeshCounts counts = {mesh.indices.size(), mesh.points, mesh.faces()};
    normals.settle(counts);
    colors.settle(counts);
    for (Layer& layer : uvs) layer.settle(counts);
    if (normals.empty()) {
        normals =
            Layer(Layer::by_corner, 3, normals_of_smoothing(document, geometry, mesh.positions, mesh.indices, mesh.sizes));
    }
    const bool has_uvs = std::any_of(uvs.begin(), uvs.end(), [](const Layer& layer) { return !layer.empty(); });
    if (normals.empty() && colors.empty() && !has_uvs) return mesh;
    const bool has_uvs2 = has_uvs && std::any_of(wanted.uv_sets.begin(), wanted.uv_sets.end(),
                                                 [](const UvSets& sets) { return sets.size() > 1; });
    importers::VertexCopies copies(mesh, !normals.empty(), has_uvs, has_uvs2, !colors.empty(), mesh.copy_of);
    for_corners(mesh.indices, mesh.sizes, [&](const Corner& c) {
        if (c.vertex >= mesh.points) return;
        const size_t slot = mesh.slots.empty() ? 0 : static_cast<size_t>(mesh.slots[c.face]);
        const std::array<size_t, kMostUvSets> sets =
            slot < uv_of_slot.size() ? uv_of_slot[slot] : std::array<size_t, kMostUvSets>{};
        std::array<float, 4> color{};
        if (!colors.empty()) color = linear_color(colors, c);
        const rt_u32 vertex =
            copies.vertex(static_cast<rt_u32>(c.vertex),
                          {normals.at(c), uvs[sets[0]].at(c), uvs[sets[1]].at(c), colors.empty() ? nullptr : color.data()});
        mesh.indices[c.corner] = static_cast<int32_t>(vertex);
    });
    return mesh;
}

SceneMesh pass(const Context& context, const Wanted& wanted, MeshData& mesh, const std::vector<rt_u32>& ids,
               const std::string& name) {
    std::vector<rt_u32> materials;
    for (const int32_t slot : mesh.slots)
        materials.push_back(static_cast<size_t>(slot) < ids.size() ? ids[static_cast<size_t>(slot)] : RT_NONE);
    if (mesh.slots.empty() && !ids.empty()) materials.push_back(ids[0]);
    const auto* const corners = reinterpret_cast<const rt_u32*>(mesh.indices.data());
    const rt_u32 id = mesh.pass(name, corners, mesh.indices.size(), materials, context.sink);
    const Vec3 origin = {mesh.origin[0], mesh.origin[1], mesh.origin[2]};
    return {id, wanted.object, wanted.node, static_cast<uint32_t>(mesh.points), std::move(mesh.copy_of), origin};
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
    rt_instance_desc out = rt::instance(mesh, context.objects[node.object].name.c_str());
    std::transform(node.geometry.begin(), node.geometry.end(), out.world_from_object,
                   [](double x) { return static_cast<float>(x); });
    const double exact[3] = {node.geometry[3], node.geometry[7], node.geometry[11]};
    out.translation = exact;
    out.node = node.id;
    rt::id(context.sink.instance(context.sink.ctx, &out));
}

// Numbers of geometry that are decoded at the same time, about: 12 MB.
constexpr uint64_t kBatchNumbers = 3u << 20;

// Each corner has a vertex, and mostly a normal and texture coordinates.
uint64_t numbers_in(const Document& document, const Node& geometry) {
    const Node *vertices = document.child(&geometry, "Vertices"), *corners = document.child(&geometry, "PolygonVertexIndex");
    return (vertices ? document.count(*vertices) : 0) + (corners ? 6 * document.count(*corners) : 0);
}

}  // namespace

std::vector<SceneMesh> add_meshes(const Context& context, const std::vector<SceneNode>& nodes) {
    Materials materials(context);
    // A geometry becomes one mesh for each list of materials that nodes give it.
    std::map<std::pair<uint32_t, std::vector<uint32_t>>, size_t> known;
    std::vector<Wanted> wanted;
    std::vector<std::pair<uint32_t, size_t>> shown;  // node, number in `wanted`
    for (uint32_t n = 0; n < nodes.size(); ++n) {
        for (const uint32_t object : meshes_of(context, nodes[n].object)) {
            const std::vector<uint32_t> slots = materials.of(nodes[n].object);
            const auto [at, is_new] = known.emplace(std::make_pair(object, slots), wanted.size());
            if (is_new) wanted.push_back({object, n, context.objects[object].node, slots, materials.uv_sets(nodes[n].object)});
            shown.push_back({n, at->second});
        }
    }
    std::vector<SceneMesh> meshes;
    for (size_t first = 0; first < wanted.size();) {
        size_t end = first;
        uint64_t numbers = 0;
        while (end < wanted.size() && end - first < 256 && numbers < kBatchNumbers) {
            numbers += numbers_in(context.document, *wanted[end++].geometry);
        }
        std::vector<MeshData> data(end - first);
        rt::parallel_for(context.host, static_cast<rt_u32>(data.size()),
                         [&](rt_u32 i) { data[i] = read_mesh(context, wanted[first + i]); });
        for (size_t i = first; i < end; ++i) {
            const Wanted& w = wanted[i];
            std::vector<rt_u32> ids;
            for (const uint32_t material : w.materials) ids.push_back(materials.id(material, nodes[w.node].object));
            const std::string& own = context.objects[w.object].name;
            meshes.push_back(
                pass(context, w, data[i - first], ids, own.empty() ? context.objects[nodes[w.node].object].name : own));
            data[i - first] = MeshData();
        }
        first = end;
        context.file.forget();
        rt::progress(context.host, 0.1f + 0.8f * static_cast<float>(first) / static_cast<float>(wanted.size()));
    }
    materials.report();
    for (const auto& [node, mesh] : shown) show(context, nodes[node], meshes[mesh].id);
    return meshes;
}

}  // namespace fbx_import
