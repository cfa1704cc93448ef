// deformers.cpp -- skins and morphs: what moves the vertices of a mesh.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <unordered_map>

#include "../common/keys.hpp"
#include "../common/mesh_arrays.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

// Where models stood when skins were bound: `Pose: "Pose::skin", "BindPose" { PoseNode: { Node: "Model::Bone"  Matrix: ... }
// }`, with ids in place of names from version 7 on. Measured from maya_game_sausage_7500_binary_combined.
class BindPoses {
 public:
    explicit BindPoses(const Context& context) : context_(context) {}
    std::optional<Transform> of(uint32_t model) {
        if (!is_read_) read();
        const auto found = matrices_.find(key(*context_.objects[model].node));
        if (found == matrices_.end()) return {};
        return matrix(context_.document, *found->second, "Matrix");
    }
    // A child of 16 numbers, column by column.
    static std::optional<Transform> matrix(const Document& document, const Node& node, std::string_view name) {
        const std::vector<double> numbers = document.numbers<double>(&node, name);
        if (numbers.size() < 16) return {};
        return from_columns(numbers.data());
    }

 private:
    std::string key(const Node& node) const {
        const Value v = context_.document.value(node, 0);
        return v.kind == Value::integer ? std::to_string(v.whole) : std::string(v.text);
    }
    void read() {
        const Document& document = context_.document;
        is_read_ = true;
        for (const uint32_t pose : context_.objects.of_kind("Pose")) {
            if (document.text(context_.objects[pose].node, "Type") == "RestPose") continue;
            for (const Node& placed : document.children(*context_.objects[pose].node)) {
                const Node* model = placed.name == "PoseNode" ? document.child(&placed, "Node") : nullptr;
                if (model) matrices_.emplace(key(*model), &placed);
            }
        }
    }
    const Context& context_;
    bool is_read_ = false;
    std::unordered_map<std::string, const Node*> matrices_;
};

std::string short_text(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

class Deformers {
 public:
    Deformers(const Context& context, const std::vector<SceneNode>& nodes, const SceneMesh& mesh, BindPoses& poses,
              Morphs& morphs)
        : context_(context),
          document_(context.document),
          nodes_(nodes),
          mesh_(mesh),
          copies_(mesh.points, mesh.copy_of),
          poses_(poses),
          morphs_(morphs) {}
    void add();

 private:
    void add_skin(uint32_t skin);
    void add_oldest_skin();
    void add_bone(const Node& cluster, uint32_t bone);
    std::optional<Transform> bone_from_node(const Node& cluster, uint32_t bone) const;
    void add_oldest_shapes();
    double oldest_weight(const std::string& shape) const;
    void add_channel(uint32_t channel);
    void add_shape(const Node& shape, double weight, const std::vector<double>& percentages, importers::Morph& morph);
    void pass(importers::Morph& morph, uint32_t owner, const std::string& key);

    const Context& context_;
    const Document& document_;
    const std::vector<SceneNode>& nodes_;
    const SceneMesh& mesh_;
    const importers::CopiesOfVertices copies_;
    BindPoses& poses_;
    Morphs& morphs_;
    importers::Skin skin_;
    size_t bones_left_out_ = 0;
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
    if (!skin_.bones.empty() && mesh_.origin != Vec3{}) {
        context_.warn(
            "'" + objects[mesh_.object].name + "' lies far from the origin (near " + short_text(mesh_.origin[0]) + ", " +
            short_text(mesh_.origin[1]) + ", " + short_text(mesh_.origin[2]) +
            "), where its bones move it in floats: fine details are lost; move the file's objects to the origin before");
    }
    if (bones_left_out_ > 0) {
        const std::string many = bones_left_out_ == 1 ? "a bone" : std::to_string(bones_left_out_) + " bones";
        context_.warn(many + " of the skin of '" + objects[mesh_.object].name +
                      "' left out: the file has no such node, or does not say where it stood when it was bound");
    }
    add_oldest_shapes();
}

// Clusters hang from the skin, and the model of a bone hangs from each cluster. Transform: from the mesh to the bone, when both
// are bound. Source: FBX SDK help, "FbxCluster"; measured from max_transformed_skin_6100_ascii.
void Deformers::add_skin(uint32_t skin) {
    const Objects& objects = context_.objects;
    for (const uint32_t cluster : objects.below(skin, "Deformer", "Cluster")) {
        const std::vector<uint32_t> bones = objects.below(cluster, "Model");
        add_bone(*objects[cluster].node, bones.empty() ? kNoObject : bones[0]);
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
        if (link.name == "Link") add_bone(link, context_.objects.find(document_.text(&link, 0)));
    }
}

void Deformers::add_bone(const Node& cluster, uint32_t bone) {
    const std::vector<int32_t> indices = document_.numbers<int32_t>(&cluster, "Indexes");
    const std::vector<float> weights = document_.numbers<float>(&cluster, "Weights");
    if (indices.empty()) return;
    const auto node = std::find_if(nodes_.begin(), nodes_.end(), [&](const SceneNode& n) { return n.object == bone; });
    const std::optional<Transform> to_bone = node == nodes_.end() ? std::nullopt : bone_from_node(cluster, bone);
    if (!to_bone) {
        ++bones_left_out_;
        return;
    }
    const Transform bind = multiply(multiply(*to_bone, nodes_[mesh_.node].geometry), translation(mesh_.origin));
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

// Where a cluster has no Transform, the place of the bone at binding (TransformLink) and that of the mesh's node give it.
std::optional<Transform> Deformers::bone_from_node(const Node& cluster, uint32_t bone) const {
    if (const auto stated = BindPoses::matrix(document_, cluster, "Transform")) return stated;
    std::optional<Transform> link = BindPoses::matrix(document_, cluster, "TransformLink");
    if (!link) link = poses_.of(bone);
    const std::optional<Transform> mesh = poses_.of(nodes_[mesh_.node].object);
    Transform to_bone{};
    if (!link || !mesh || !invert(*link, to_bone)) return {};
    return multiply(to_bone, *mesh);
}

// Up to version 7.1, shapes are blocks of the model or geometry, which has a property with the name of each, in percent
// (measured from maya_blend_shape_cube_6100_binary, and maya_blend_shape_cube_7100_ascii of ufbx).
void Deformers::add_oldest_shapes() {
    for (const Node& shape : document_.children(*context_.objects[mesh_.object].node)) {
        if (shape.name != "Shape") continue;
        importers::Morph morph;
        morph.name = document_.text(&shape, 0);
        morph.weight = oldest_weight(morph.name) / 100;
        add_shape(shape, 1, {}, morph);
        pass(morph, mesh_.object, morph.name);
    }
}

// In percent. Up to version 5.8, the default of a channel of the model or of the current take, as of transforms (measured from
// max7_blend_cube_5000_binary of ufbx).
double Deformers::oldest_weight(const std::string& shape) const {
    if (document_.version() >= 6000) return context_.properties(mesh_.object).number(shape, 0);
    const Node* model = context_.objects[mesh_.object].node;
    for (const Node* owner : {model, in_current_take(document_, *model)}) {
        for (const std::string& name : {shape + kShapeSuffix, shape}) {
            const Node* rest = document_.child(document_.child(owner, "Channel", name), "Default");
            if (rest) return document_.number(rest, 0, 0);
        }
    }
    return 0;
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
    BindPoses poses(context);
    for (const SceneMesh& mesh : meshes) Deformers(context, nodes, mesh, poses, morphs).add();
}

}  // namespace fbx_import
