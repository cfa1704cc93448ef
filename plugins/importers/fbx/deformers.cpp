// deformers.cpp -- skins and morphs: what moves the vertices of a mesh.
#include <algorithm>

#include "../common/keys.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

// A matrix of 16 numbers as the file writes them, column by column; false if there are fewer.
bool matrix_of(const std::vector<double>& numbers, Transform& out) {
    if (numbers.size() < 16) return false;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) out[4 * row + column] = numbers[4 * column + row];
    }
    return true;
}

// The host's vertices of each vertex of the file: itself, and its copies.
class Copies {
 public:
    explicit Copies(const SceneMesh& mesh) : mesh_(mesh) {
        for (uint32_t i = 0; i < mesh.copy_of.size(); ++i) copies_.emplace_back(mesh.copy_of[i], mesh.points + i);
        std::stable_sort(copies_.begin(), copies_.end());
    }
    template <class Body>
    void each(int32_t vertex, const Body& body) const {
        if (vertex < 0 || static_cast<uint32_t>(vertex) >= mesh_.points) return;
        const rt_u32 v = static_cast<rt_u32>(vertex);
        body(v);
        auto at = std::lower_bound(copies_.begin(), copies_.end(), std::make_pair(v, rt_u32(0)));
        for (; at != copies_.end() && at->first == v; ++at) body(at->second);
    }

 private:
    const SceneMesh& mesh_;
    std::vector<std::pair<rt_u32, rt_u32>> copies_;
};

// A shape of the file. `weight`: at which the mesh has reached it.
struct Shape {
    double weight;
    const Node* node;
    std::vector<float> shares;  // by which each vertex follows it; empty: fully
};

class Deformers {
 public:
    Deformers(const Context& context, const std::vector<SceneNode>& nodes, const SceneMesh& mesh, Morphs& morphs)
        : context_(context), document_(context.document), nodes_(nodes), mesh_(mesh), copies_(mesh), morphs_(morphs) {}
    void add();

 private:
    void add_skin(uint32_t skin);
    void add_oldest_skin();
    void add_bone(const Node& cluster, uint32_t bone);
    void add_channel(uint32_t channel);
    void pass_morph(const std::string& name, double weight, const std::vector<Shape>& shapes, uint32_t owner,
                    const std::string& key);

    const Context& context_;
    const Document& document_;
    const std::vector<SceneNode>& nodes_;
    const SceneMesh& mesh_;
    const Copies copies_;
    Morphs& morphs_;
    importers::Skin skin_;
};

void Deformers::add() {
    const Objects& objects = context_.objects;
    std::vector<uint32_t> deformers = objects.below(mesh_.object, "Deformer");
    bool has_skin = false;
    for (const uint32_t deformer : deformers) {
        const std::string_view type = objects[deformer].type;
        if (type == "Skin" && !has_skin) {
            add_skin(deformer);
            has_skin = true;
        } else if (type == "Skin") {
            context_.warn("a mesh has several skins; the first one moves it: '" + objects[mesh_.object].name + "'");
        } else if (type == "BlendShape") {
            for (const uint32_t channel : objects.below(deformer, "Deformer", "BlendShapeChannel")) add_channel(channel);
        } else if (type == "VertexCacheDeformer") {
            add_cache(context_, mesh_, deformer);
        }
    }
    const Node* geometry = objects[mesh_.object].node;
    if (!has_skin && document_.child(geometry, "Link")) add_oldest_skin();
    if (!skin_.bones.empty()) skin_.pass(mesh_.id, context_.sink);
    // Before version 7, shapes are blocks of the model (measured from maya_blend_shape_cube_6100_binary).
    for (const Node& shape : document_.children(*geometry)) {
        if (shape.name != "Shape") continue;
        const std::string name(document_.text(&shape, 0));
        pass_morph(name, 0, {{1, &shape, {}}}, mesh_.object, name);
    }
}

// Clusters hang from the skin, and the model of a bone hangs from each cluster. Transform: from the mesh to the bone, when both
// are bound. Source: FBX SDK help, "FbxCluster"; measured from max_transformed_skin_6100_ascii.
void Deformers::add_skin(uint32_t skin) {
    const Objects& objects = context_.objects;
    for (const uint32_t cluster : objects.below(skin, "Deformer", "Cluster")) {
        const std::vector<uint32_t> bones = objects.below(cluster, "Model");
        if (!bones.empty()) add_bone(*objects[cluster].node, bones[0]);
    }
    const std::string_view type = document_.text(document_.child(objects[skin].node, "SkinningType"), 0);
    if (type == "DualQuaternion") skin_.method = RT_SKIN_DUAL_QUATERNION;
    if (type == "Blend") {
        skin_.method = RT_SKIN_BLENDED;
        std::vector<float>& shares = skin_.dual_quaternion_shares;
        shares.resize(mesh_.points + mesh_.copy_of.size());
        const std::vector<int32_t> indices = document_.numbers<int32_t>(objects[skin].node, "Indexes");
        const std::vector<float> blend = document_.numbers<float>(objects[skin].node, "BlendWeights");
        for (size_t i = 0; i < std::min(indices.size(), blend.size()); ++i) {
            copies_.each(indices[i], [&](rt_u32 v) { shares[v] = std::clamp(blend[i], 0.f, 1.f); });
        }
    }
}

// Up to version 5.8: `Link: "Bone" { Indexes, Weights, Transform }` in the model (measured from max7_skin_5000_binary).
void Deformers::add_oldest_skin() {
    for (const Node& link : document_.children(*context_.objects[mesh_.object].node)) {
        const uint32_t bone = link.name == "Link" ? context_.objects.find(document_.text(&link, 0)) : kNoObject;
        if (bone != kNoObject) add_bone(link, bone);
    }
}

void Deformers::add_bone(const Node& cluster, uint32_t bone) {
    const std::vector<int32_t> indices = document_.numbers<int32_t>(&cluster, "Indexes");
    const std::vector<float> weights = document_.numbers<float>(&cluster, "Weights");
    const auto node = std::find_if(nodes_.begin(), nodes_.end(), [&](const SceneNode& n) { return n.object == bone; });
    Transform bind = kIdentity;
    if (indices.empty() || node == nodes_.end() || !matrix_of(document_.numbers<double>(&cluster, "Transform"), bind)) return;
    bind = multiply(bind, nodes_[mesh_.node].geometry);
    if (!is_finite(bind)) throw Broken(document_.place(cluster) + ": the matrix of a bone is not finite");
    rt_bone out{};
    out.node = node->id;
    std::copy(bind.begin(), bind.end(), out.bone_from_mesh);
    const rt_u32 number = static_cast<rt_u32>(skin_.bones.size());
    skin_.bones.push_back(out);
    for (size_t i = 0; i < std::min(indices.size(), weights.size()); ++i) {
        copies_.each(indices[i], [&](rt_u32 v) { skin_.weights.push_back({v, number, weights[i]}); });
    }
}

// FullWeights: at which percentage of DeformPercent each shape is reached. Source: FBX SDK help, "FbxBlendShapeChannel".
void Deformers::add_channel(uint32_t channel) {
    const Objects& objects = context_.objects;
    const std::vector<double> full = document_.numbers<double>(objects[channel].node, "FullWeights");
    std::vector<Shape> shapes;
    for (const uint32_t shape : objects.below(channel, "Geometry", "Shape")) {
        const double percent = shapes.size() < full.size() ? full[shapes.size()] : 100;
        shapes.push_back({percent / 100, objects[shape].node, {}});
    }
    // Blender writes the share of each vertex there (measured from blender440_shape_weight_anim_7400_binary).
    if (shapes.size() == 1 && full.size() > 1 && document_.numbers<int32_t>(shapes[0].node, "Indexes").size() == full.size()) {
        shapes[0].weight = 1;
        for (const double share : full) shapes[0].shares.push_back(static_cast<float>(share / 100));
    }
    const double percent = context_.properties(channel).number("DeformPercent", 0);
    pass_morph(objects[channel].name, percent / 100, shapes, channel, "");
}

void Deformers::pass_morph(const std::string& name, double weight, const std::vector<Shape>& shapes, uint32_t owner,
                           const std::string& key) {
    struct Offsets {
        std::vector<rt_u32> vertices;
        std::vector<float> positions, normals;
    };
    std::vector<Offsets> offsets(shapes.size());
    std::vector<rt_morph_target> targets;
    for (size_t s = 0; s < shapes.size(); ++s) {
        const Node* shape = shapes[s].node;
        const std::vector<int32_t> indices = document_.numbers<int32_t>(shape, "Indexes");
        const std::vector<float> turns = document_.numbers<float>(shape, "Normals");
        std::vector<float> moves = document_.numbers<float>(shape, "Vertices");
        for (size_t i = 0; i < std::min(moves.size(), 3 * shapes[s].shares.size()); ++i) moves[i] *= shapes[s].shares[i / 3];
        Offsets& out = offsets[s];
        std::vector<bool> seen(mesh_.points);
        for (size_t i = 0; i < std::min(indices.size(), moves.size() / 3); ++i) {
            if (indices[i] < 0 || static_cast<uint32_t>(indices[i]) >= mesh_.points || seen[static_cast<size_t>(indices[i])])
                continue;
            seen[static_cast<size_t>(indices[i])] = true;
            copies_.each(indices[i], [&](rt_u32 v) {
                out.vertices.push_back(v);
                out.positions.insert(out.positions.end(), &moves[3 * i], &moves[3 * i] + 3);
                if (turns.size() == moves.size()) out.normals.insert(out.normals.end(), &turns[3 * i], &turns[3 * i] + 3);
            });
        }
        if (out.vertices.empty() || shapes[s].weight == 0) continue;
        rt_morph_target target{};
        target.weight = shapes[s].weight;
        target.vertices = out.vertices.data();
        target.count = out.vertices.size();
        target.positions = out.positions.data();
        target.normals = out.normals.empty() ? nullptr : out.normals.data();
        targets.push_back(target);
    }
    if (targets.empty()) return;
    std::stable_sort(targets.begin(), targets.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
    rt_morph_desc out{};
    out.struct_bytes = sizeof out;
    out.mesh = mesh_.id;
    out.name = name.c_str();
    out.weight = weight;
    out.targets = targets.data();
    out.target_count = static_cast<rt_u32>(targets.size());
    morphs_[{owner, key}].push_back(rt::id(context_.sink.morph(context_.sink.ctx, &out)));
}

}  // namespace

void add_deformers(const Context& context, const std::vector<SceneNode>& nodes, const std::vector<SceneMesh>& meshes,
                   Morphs& morphs) {
    for (const SceneMesh& mesh : meshes) Deformers(context, nodes, mesh, morphs).add();
}

}  // namespace fbx_import
