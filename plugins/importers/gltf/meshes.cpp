#include "meshes.hpp"

#include <algorithm>
#include <limits>

#include "../common/mesh_arrays.hpp"
#include "rt_plugin.hpp"
#include "tolerant.hpp"

namespace gltf_import {
namespace {

constexpr size_t kNone = size_t(-1);
// Infinite if the number is too large for a float.
float to_float(double x) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return x >= -kMost && x <= kMost ? static_cast<float>(x) : std::numeric_limits<float>::infinity();
}

enum Mode : uint64_t { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kStrip, kFan };

}  // namespace

struct Meshes::Geometry : importers::MeshArrays {
    std::vector<rt_u32> indices, materials;
    std::vector<Part> parts;
    bool has_normals = false, has_uvs = false, has_uvs2 = false, has_tangents = false, has_colors = false;
};

Meshes::Meshes(const Document& document, Accessors& accessors, Materials& materials, const NodeTree& tree,
               const rt_scene_sink& sink, std::set<size_t> animated)
    : accessors_(accessors),
      materials_(materials),
      tree_(tree),
      sink_(sink),
      meshes_(document.list("meshes")),
      skins_(document.list("skins")),
      animated_(std::move(animated)) {}

void Meshes::place(size_t node) {
    const Value value = tree_.list()[node];
    const auto mesh = value.index("mesh", meshes_), skin = value.index("skin", skins_);
    if (!mesh) return;
    copies_left_out_ = copies_left_out_ || value.object("extensions").has("EXT_mesh_gpu_instancing");
    const bool has_own_weights = value.has("weights") || animated_.count(node) > 0;
    const std::tuple key(*mesh, skin.value_or(kNone), has_own_weights ? node : kNone);
    const std::string name = value.name().empty() ? meshes_[*mesh].name() : value.name();
    auto known = built_.find(key);
    if (known == built_.end()) known = built_.emplace(key, build(meshes_[*mesh], value, name)).first;
    of_node_[node] = &known->second;
    if (known->second.mesh == RT_NONE) return;
    rt_instance_desc out = rt::instance(known->second.mesh, name.c_str());
    out.node = tree_.id(node);
    rt::id(sink_.instance(sink_.ctx, &out));
}

const std::vector<rt_u32>& Meshes::morphs(size_t node) const {
    static const std::vector<rt_u32> none;
    const auto found = of_node_.find(node);
    return found == of_node_.end() ? none : found->second->morphs;
}

void Meshes::report() const {
    if (copies_left_out_) rt::warn(sink_, "copies by EXT_mesh_gpu_instancing are left out: one of each is there");
    if (unweighted_ > 0)
        rt::warn(sink_, unweighted_ == 1 ? "a vertex of a mesh with a skin has no weights; it follows the first joint"
                                         : std::to_string(unweighted_) +
                                               " vertices of meshes with skins have no weights; they "
                                               "follow the first joint");
    if (triangles_ == 0) {
        rt::warn(sink_, "contains no polygons" + std::string(points_and_lines_ ? " (points and lines were skipped)" : ""));
    } else if (points_and_lines_ > 0) {
        rt::warn(sink_, "points and lines are left out: " + std::to_string(points_and_lines_) + " primitives of meshes");
    }
}

Meshes::Built Meshes::build(const Value& mesh, const Value& node, const std::string& name) {
    Geometry g;
    const Value primitives = mesh["primitives"];
    for (size_t i = 0; i < primitives.size(); ++i) add_primitive(primitives[i], g);
    Built built;
    if (g.indices.empty()) return built;
    triangles_ += g.indices.size() / 3;
    g.normals.resize(g.has_normals ? g.positions.size() : 0);  // zeros: the vertex has none
    g.uvs.resize(g.has_uvs ? g.positions.size() / 3 * 2 : 0);
    g.uvs2.resize(g.has_uvs2 ? g.positions.size() / 3 * 2 : 0);
    g.tangents.resize(g.has_tangents ? g.positions.size() / 3 * 4 : 0);
    g.colors.resize(g.has_colors ? g.positions.size() / 3 * 4 : 0, 1.0f);  // ones: the material's colour stays as it is

    built.mesh = g.pass(name, g.indices.data(), g.indices.size(), g.materials, sink_);
    if (const auto skin = node.index("skin", skins_)) add_skin(skins_[*skin], built.mesh, g.parts);
    built.morphs = add_morphs(mesh, node, built.mesh, g.parts);
    return built;
}

void Meshes::add_primitive(const Value& primitive, Geometry& g) {
    const uint64_t mode = primitive.count("mode", kTriangles);
    if (mode > kFan) primitive["mode"].refuse("0 to 6");
    const Value attributes = primitive["attributes"];
    if (mode < kTriangles || !attributes.has("POSITION")) {
        ++points_and_lines_;
        return;
    }
    add_faces(primitive, add_vertices(primitive, g), g);
}

std::shared_ptr<const DracoMesh> Meshes::draco_of(const Value& primitive) {
    const Value extensions = primitive.object("extensions");
    if (!extensions.has("KHR_draco_mesh_compression")) return nullptr;
    const Value draco = extensions["KHR_draco_mesh_compression"];
    std::shared_ptr<const DracoMesh> mesh;
    const auto decode = [&] { mesh = std::make_shared<DracoMesh>(draco, accessors_.view(draco["bufferView"])); };
    // The accessors may also have the data without compression, for programs that do not know the extension.
    if (accessors_.has_view(primitive["attributes"]["POSITION"]))
        spared(sink_, "the data without compression is taken", decode);
    else
        decode();
    return mesh;
}

namespace {

// What Draco has compressed must fit to what it has not: an attribute may be in either.
void expect_count(const Value& reference, uint64_t found, uint64_t count) {
    if (count != kAnyCount && found != count)
        reference.refuse(std::to_string(found) + " elements in what Draco has compressed",
                         std::to_string(count) + " as in POSITION");
}

}  // namespace

Elements<float> Meshes::floats(const Part& part, const std::string& attribute, std::string_view types, uint64_t count) {
    const Value reference = part.primitive["attributes"][attribute.c_str()];
    if (!part.draco) return accessors_.floats(reference, types, count);
    const Value ids = part.primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"];
    if (!ids.has(attribute.c_str())) return accessors_.floats(reference, types, count);
    const Accessors::Form form = accessors_.form(reference, types, false);
    Elements<float> out;
    out.components = form.components;
    out.count = part.draco->vertex_count();
    expect_count(reference, out.count, count);
    out.values = part.draco->floats(ids[attribute.c_str()], form.components, form.is_normalized, form.component_type);
    return out;
}

Elements<uint32_t> Meshes::integers(const Part& part, const std::string& attribute, std::string_view types, uint64_t count) {
    const Value reference = part.primitive["attributes"][attribute.c_str()];
    if (!part.draco) return accessors_.integers(reference, types, count);
    const Value ids = part.primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"];
    if (!ids.has(attribute.c_str())) return accessors_.integers(reference, types, count);
    Elements<uint32_t> out;
    out.components = accessors_.form(reference, types, true).components;
    out.count = part.draco->vertex_count();
    expect_count(reference, out.count, count);
    out.values = part.draco->integers(ids[attribute.c_str()], out.components);
    return out;
}

// Primitives with the same attributes share their vertices.
const Part& Meshes::add_vertices(const Value& primitive, Geometry& g) {
    const Value attributes = primitive["attributes"];
    const TextureSets sets = materials_.sets(primitive);
    if (!g.parts.empty()) {
        const Part& last = g.parts.back();
        const Value before = last.primitive;
        const bool is_draco = last.draco || primitive.object("extensions").has("KHR_draco_mesh_compression");
        if (!is_draco && before["attributes"].json() == attributes.json() &&
            before.list("targets").json() == primitive.list("targets").json() && last.sets == sets) {
            return last;
        }
    }
    Part part = {primitive, 0, 0, sets, draco_of(primitive)};
    const Elements<float> positions = floats(part, "POSITION", "VEC3", kAnyCount);
    if (const uint64_t stated = accessors_.form(attributes["POSITION"], "VEC3", false).count; stated != positions.count)
        rt::warn(sink_, attributes.path() + ".POSITION: found " + std::to_string(stated) + " vertices, but " +
                            std::to_string(positions.count) + " in what Draco has compressed, which are taken");
    const uint64_t count = part.count = positions.count;
    const size_t first = g.positions.size() / 3;
    part.first = static_cast<rt_u32>(first);
    if (first + count >= RT_NONE) attributes["POSITION"].refuse("more than 4 billion vertices in one mesh", "fewer");
    g.positions.insert(g.positions.end(), positions.values.begin(), positions.values.end());
    // Without them the shape is the same, but not its look.
    if (attributes.has("NORMAL")) {
        spared(sink_, "the normals are left out", [&] {
            const Elements<float> normals = floats(part, "NORMAL", "VEC3", count);
            g.normals.resize(3 * first);
            g.normals.insert(g.normals.end(), normals.values.begin(), normals.values.end());
            g.has_normals = true;
        });
    }
    // The tangents of flat normals are the host's: specification, section 3.7.2.1.
    if (attributes.has("TANGENT") && attributes.has("NORMAL")) {
        spared(sink_, "the tangents are left out", [&] {
            const Elements<float> tangents = floats(part, "TANGENT", "VEC4", count);
            g.tangents.resize(4 * first);
            g.tangents.insert(g.tangents.end(), tangents.values.begin(), tangents.values.end());
            g.has_tangents = true;
        });
    }
    for (size_t k = 0; k < sets.size(); ++k) {
        const std::string set = "TEXCOORD_" + std::to_string(sets[k]);
        const char* const uv = attributes.has(set.c_str()) ? set.c_str() : "TEXCOORD_0";
        if (!attributes.has(uv)) continue;
        if (set != uv)
            rt::warn(sink_,
                     attributes.path() + ": the material names " + set + ", which is missing; " + uv + " takes its place");
        spared(sink_, "the texture coordinates are left out", [&] {
            std::vector<float>& to = k == 0 ? g.uvs : g.uvs2;
            const Elements<float> uvs = floats(part, uv, "VEC2", count);
            to.resize(2 * first);
            for (size_t i = 0; i < count; ++i) {
                to.push_back(uvs.values[2 * i]);
                to.push_back(to_float(1 - double(uvs.values[2 * i + 1])));  // (0, 0) is at the top left in glTF
            }
            (k == 0 ? g.has_uvs : g.has_uvs2) = true;
        });
    }
    if (attributes.has("COLOR_0")) {
        spared(sink_, "the colours of vertices are left out", [&] {
            const Elements<float> colors = floats(part, "COLOR_0", "VEC3 or VEC4", count);
            g.colors.resize(4 * first, 1.0f);
            // Linear, and limited to 0..1: specification, section 3.7.2.1.
            for (size_t i = 0; i < count; ++i)
                for (size_t k = 0; k < 4; ++k)
                    g.colors.push_back(k < colors.components ? std::clamp(colors.values[colors.components * i + k], 0.0f, 1.0f)
                                                             : 1.0f);
            g.has_colors = true;
        });
    }
    g.parts.push_back(std::move(part));
    return g.parts.back();
}

void Meshes::add_faces(const Value& primitive, const Part& part, Geometry& g) {
    const rt_u32 first = part.first;
    const uint64_t count = part.count;
    std::vector<rt_u32> corners;
    uint64_t mode = primitive.count("mode", kTriangles);
    if (part.draco) {
        corners = part.draco->indices();
        mode = kTriangles;
    } else if (primitive.has("indices")) {
        corners = accessors_.integers(primitive["indices"], "SCALAR").values;
    } else {
        corners.resize(count);
        for (size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<rt_u32>(i);
    }
    const auto wrong = std::find_if(corners.begin(), corners.end(), [&](rt_u32 i) { return i >= count; });
    std::string found;
    if (wrong != corners.end())
        found = "the index " + std::to_string(*wrong) + " at position " + std::to_string(wrong - corners.begin()) +
                " of its indices";
    for (rt_u32& i : corners) i = i < count ? first + i : RT_NONE;  // the host leaves such faces out, and counts them
    const size_t n = corners.size(), step = mode == kTriangles ? 3 : 1;
    if (mode == kTriangles && n % 3 != 0)
        rt::warn(sink_, primitive.path() + ": found " + std::to_string(n) +
                            " corners, expected three for each triangle; the rest is left out");
    size_t added = 0, usable = 0;
    for (size_t i = 0; i + 2 < n; i += step, ++added) {
        // Specification, section 3.7.2.1: every other triangle of a strip is turned, so that all show the same side.
        const size_t odd = mode == kStrip ? i % 2 : 0;
        const rt_u32 strip[3] = {corners[i], corners[i + 1 + odd], corners[i + 2 - odd]};
        const rt_u32 fan[3] = {corners[i + 1], corners[i + 2], corners[0]};
        const rt_u32* const triangle = mode == kFan ? fan : strip;
        g.indices.insert(g.indices.end(), triangle, triangle + 3);
        usable += std::count(triangle, triangle + 3, RT_NONE) == 0;
    }
    if (!found.empty()) {
        const std::string expected = "one below " + std::to_string(count) + ", its number of vertices";
        if (usable == 0) primitive.refuse(found, expected);
        rt::warn(sink_, primitive.path() + ": found " + found + ", expected " + expected);
    }
    if (added > 0) g.materials.insert(g.materials.end(), added, materials_.id(primitive));
}

}  // namespace gltf_import
