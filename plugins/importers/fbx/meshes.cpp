#include <algorithm>
#include <array>

#include "../common/mesh_arrays.hpp"
#include "../common/numbers.hpp"
#include "../common/smooth_normals.hpp"
#include "document.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

// The data that a geometry has for its corners and faces: normals, texture coordinates, material slots.

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

Layer::Layer(Mapping mapping, size_t width, std::vector<float> values, std::vector<int32_t> indices)
    : mapping_(values.size() < width ? none : mapping),
      is_indexed_(!indices.empty()),
      width_(width),
      values_(std::move(values)),
      indices_(std::move(indices)) {}

// MappingInformationType: ByPolygonVertex, ByVertice (also ByVertex), ByPolygon, AllSame, ByEdge. ReferenceInformationType:
// Direct, IndexToDirect, and Index, its older name. Source: FBX SDK help, "FbxLayerElement"; "ByVertice": measured from
// zbrush_d20_6100_ascii. Values of edges are left out: corners have none.
Layer::Layer(const Document& document, const Node* layer, const char* values, const char* indices, size_t width) {
    if (!layer) return;
    const std::string_view mapping = document.text(layer, "MappingInformationType");
    const std::string_view reference = document.text(layer, "ReferenceInformationType");
    if (mapping == "ByEdge" || mapping == "NoMappingInformation") return;
    // Old exporters write IndexToDirect without indices, and mean Direct.
    const bool is_indexed = reference == "IndexToDirect" || reference == "Index";
    *this = Layer(mapping == "ByPolygonVertex"                      ? by_corner
                  : mapping == "ByVertice" || mapping == "ByVertex" ? by_vertex
                  : mapping == "ByPolygon"                          ? by_face
                  : mapping == "AllSame"                            ? all_same
                                                                    : unknown,
                  width, document.numbers<float>(layer, values),
                  is_indexed ? document.numbers<int32_t>(layer, indices) : std::vector<int32_t>());
}

void Layer::settle(const MeshCounts& counts) {
    if (mapping_ != unknown) return;
    const size_t count = is_indexed_ ? indices_.size() : values_.size() / width_;
    mapping_ = count == 1                 ? all_same
               : count == counts.vertices ? by_vertex
               : count == counts.corners  ? by_corner
               : count == counts.faces    ? by_face
                                          : none;
}

const float* Layer::at(const Corner& corner) const {
    static constexpr float zeros[3] = {};
    return at(corner, zeros);
}

const float* Layer::at(const Corner& corner, const float* none) const {
    size_t i = mapping_ == by_corner   ? corner.corner
               : mapping_ == by_vertex ? corner.vertex
               : mapping_ == by_face   ? corner.face
                                       : 0;
    if (is_indexed_) {
        if (i >= indices_.size() || indices_[i] < 0) return none;
        i = static_cast<size_t>(indices_[i]);
    }
    return (i + 1) * width_ <= values_.size() ? &values_[i * width_] : none;
}

// The material slot of each face; empty: all have slot 0.
std::vector<int32_t> material_slots(const Document& document, const Node& geometry, size_t faces) {
    const Node* layer = document.child(&geometry, "LayerElementMaterial");
    // Up to version 5.8: `MaterialAssignation: "ByPolygon"` and `Materials` in the model itself (measured from
    // max2009_blob_5800_ascii).
    std::string_view mapping = document.text(&geometry, "MaterialAssignation");
    if (layer) mapping = document.text(layer, "MappingInformationType");
    std::vector<int32_t> slots = document.numbers<int32_t>(layer ? layer : &geometry, "Materials");
    for (int32_t& slot : slots) slot = std::max(slot, 0);
    if (slots.empty()) return {};
    if (mapping == "ByPolygon") slots.resize(faces, 0);
    if (mapping != "ByPolygon") slots = std::vector<int32_t>(faces, slots[0]);
    if (std::all_of(slots.begin(), slots.end(), [](int32_t slot) { return slot == 0; })) slots.clear();
    return slots;
}

// A normal for each corner, as the file's smoothing groups or smooth edges say. Empty: it has none, or nothing is smooth.
// LayerElementSmoothing, ByPolygon: groups as bits; faces that share one are smooth where they meet. ByEdge: 1 for smooth
// edges; `Edges` names the corner at which each of them begins. Source: FBX SDK help, "FbxLayerElementSmoothing"; `Edges`:
// Blender developer blog.
std::vector<float> normals_of_smoothing(const Document& document, const Node& geometry, const std::vector<float>& positions,
                                        const std::vector<int32_t>& corners, const std::vector<uint32_t>& sizes) {
    const Node* layer = document.child(&geometry, "LayerElementSmoothing");
    const std::vector<int32_t> values = document.numbers<int32_t>(layer, "Smoothing");
    if (std::all_of(values.begin(), values.end(), [](int32_t value) { return value == 0; })) return {};
    const std::string_view mapping = document.text(layer, "MappingInformationType");
    std::vector<int32_t> of_corner(corners.size());  // the groups of its face, or whether the edge that begins there is smooth
    if (mapping == "ByEdge") {
        const std::vector<int32_t> edges = document.numbers<int32_t>(&geometry, "Edges");
        for (size_t i = 0; i < std::min(edges.size(), values.size()); ++i) {
            const auto corner = static_cast<uint32_t>(edges[i]);
            if (corner < corners.size()) of_corner[corner] = values[i];
        }
        return importers::smooth_normals(positions, corners, sizes,
                                         [&](size_t a, size_t b) { return of_corner[a] != 0 || of_corner[b] != 0; });
    }
    if (mapping != "ByPolygon") return {};
    for_corners(corners, sizes, [&](const Corner& c) { of_corner[c.corner] = c.face < values.size() ? values[c.face] : 0; });
    return importers::smooth_normals(positions, corners, sizes,
                                     [&](size_t a, size_t b) { return (of_corner[a] & of_corner[b]) != 0; });
}

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
