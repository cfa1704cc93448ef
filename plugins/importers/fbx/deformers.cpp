// deformers.cpp -- skins and morphs: what moves the vertices of a mesh.
#include <algorithm>

#include "../common/keys.hpp"
#include "../common/mesh_arrays.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

class Deformers {
 public:
    Deformers(const Context& context, const std::vector<SceneNode>& nodes, const SceneMesh& mesh, Morphs& morphs)
        : context_(context),
          document_(context.document),
          nodes_(nodes),
          mesh_(mesh),
          copies_(mesh.points, mesh.copy_of),
          morphs_(morphs) {}
    void add();

 private:
    void add_skin(uint32_t skin);
    void add_oldest_skin();
    void add_bone(const Node& cluster, uint32_t bone);
    void add_channel(uint32_t channel);
    void add_shape(const Node& shape, double weight, const std::vector<double>& percentages, importers::Morph& morph);
    void pass(importers::Morph& morph, uint32_t owner, const std::string& key);

    const Context& context_;
    const Document& document_;
    const std::vector<SceneNode>& nodes_;
    const SceneMesh& mesh_;
    const importers::CopiesOfVertices copies_;
    Morphs& morphs_;
    importers::Skin skin_;
};

void Deformers::add() {
    const Objects& objects = context_.objects;
    bool has_skin = false;
    for (const uint32_t deformer : objects.below(mesh_.object, "Deformer")) {
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
        importers::Morph morph;
        morph.name = document_.text(&shape, 0);
        add_shape(shape, 1, {}, morph);
        pass(morph, mesh_.object, morph.name);
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
    const std::string_view type = document_.text(objects[skin].node, "SkinningType");
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
    const std::vector<double> to_bone = document_.numbers<double>(&cluster, "Transform");
    if (indices.empty() || node == nodes_.end() || to_bone.size() < 16) return;
    const Transform bind = multiply(from_columns(to_bone.data()), nodes_[mesh_.node].geometry);
    if (!is_finite(bind)) document_.fail(cluster, "the matrix of a bone is not finite");
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
// Blender writes the percentage of each vertex there (measured from blender440_shape_weight_anim_7400_binary).
void Deformers::add_channel(uint32_t channel) {
    const Objects& objects = context_.objects;
    const std::vector<uint32_t> shapes = objects.below(channel, "Geometry", "Shape");
    std::vector<double> full = document_.numbers<double>(objects[channel].node, "FullWeights"), of_vertices;
    if (shapes.size() == 1 && full.size() > 1 &&
        document_.numbers<int32_t>(objects[shapes[0]].node, "Indexes").size() == full.size())
        std::swap(full, of_vertices);
    full.resize(shapes.size(), 100);
    importers::Morph morph;
    morph.name = objects[channel].name;
    morph.weight = context_.properties(channel).number("DeformPercent", 0) / 100;
    for (size_t i = 0; i < shapes.size(); ++i) add_shape(*objects[shapes[i]].node, full[i] / 100, of_vertices, morph);
    pass(morph, channel, "");
}

// weight: at which the mesh has reached the shape. percentages: by which each of its vertices follows it; empty: fully.
void Deformers::add_shape(const Node& shape, double weight, const std::vector<double>& percentages, importers::Morph& morph) {
    const std::vector<int32_t> indices = document_.numbers<int32_t>(&shape, "Indexes");
    const std::vector<float> normals = document_.numbers<float>(&shape, "Normals");
    std::vector<float> moves = document_.numbers<float>(&shape, "Vertices");
    for (size_t i = 0; i < std::min(moves.size() / 3, percentages.size()); ++i) {
        for (size_t k = 3 * i; k < 3 * i + 3; ++k) moves[k] *= static_cast<float>(percentages[i] / 100);
    }
    importers::Morph::Target target;
    target.weight = weight;
    std::vector<bool> seen(mesh_.points);
    for (size_t i = 0; i < std::min(indices.size(), moves.size() / 3); ++i) {
        const size_t vertex = static_cast<uint32_t>(indices[i]);
        if (vertex >= mesh_.points || seen[vertex]) continue;
        seen[vertex] = true;
        const float* normal = normals.size() == moves.size() ? &normals[3 * i] : nullptr;
        copies_.each(indices[i], [&](rt_u32 v) { target.add(v, &moves[3 * i], normal); });
    }
    if (!target.vertices.empty() && weight != 0) morph.targets.push_back(std::move(target));
}

void Deformers::pass(importers::Morph& morph, uint32_t owner, const std::string& key) {
    if (!morph.targets.empty()) morphs_[{owner, key}].push_back(morph.pass(mesh_.id, context_.sink));
}

}  // namespace

void add_deformers(const Context& context, const std::vector<SceneNode>& nodes, const std::vector<SceneMesh>& meshes,
                   Morphs& morphs) {
    for (const SceneMesh& mesh : meshes) Deformers(context, nodes, mesh, morphs).add();
}

}  // namespace fbx_import
