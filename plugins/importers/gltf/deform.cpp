// deform.cpp -- skins and morph targets of a mesh.
#include <algorithm>
#include <cmath>

#include "../common/keys.hpp"
#include "../common/matrix.hpp"
#include "meshes.hpp"

namespace gltf_import {
namespace {

[[noreturn]] void refuse_joint(const Value& joints, uint64_t found, size_t vertex, const Value& skin) {
    joints.refuse("joint number " + std::to_string(found) + " at vertex " + std::to_string(vertex),
                  "one of the " + std::to_string(skin["joints"].size()) + " joints of " + skin.path());
}

std::vector<rt_bone> bones_of(const Value& skin, Accessors& accessors, const NodeTree& tree) {
    const Value joints = skin["joints"];
    if (joints.size() == 0) joints.refuse("no joint", "one or more");
    std::vector<rt_bone> bones(joints.size());
    Elements<float> inverse;
    if (skin.has("inverseBindMatrices")) {
        inverse = accessors.floats(skin["inverseBindMatrices"], "MAT4");
        if (inverse.count < joints.size())
            skin["inverseBindMatrices"].refuse(std::to_string(inverse.count) + " matrices",
                                               std::to_string(joints.size()) + ", one for each joint");
    }
    for (size_t i = 0; i < bones.size(); ++i) {
        bones[i].node = tree.id(joints[i].index(tree.list()));
        const importers::Transform bind =
            inverse.count > 0 ? importers::from_columns(&inverse.values[16 * i]) : importers::kIdentity;
        std::copy(bind.begin(), bind.end(), bones[i].bone_from_mesh);
    }
    return bones;
}

}  // namespace

void Meshes::add_skin(const Value& skin, rt_u32 mesh, const std::vector<Part>& parts) {
    importers::Skin passed;
    passed.bones = bones_of(skin, accessors_, tree_);
    for (const Part& part : parts) {
        const Value attributes = part.primitive["attributes"];
        std::vector<bool> has_weight(part.count);
        for (int set = 0;; ++set) {
            const std::string joints_key = "JOINTS_" + std::to_string(set), weights_key = "WEIGHTS_" + std::to_string(set);
            if (!attributes.has(joints_key.c_str())) break;
            const Value joints_of = attributes[joints_key.c_str()];
            const Elements<uint32_t> joints = integers(part, joints_key, "VEC4", part.count);
            const Elements<float> shares = floats(part, weights_key, "VEC4", part.count);
            for (size_t i = 0; i < shares.values.size(); ++i) {
                if (!(shares.values[i] > 0) || !std::isfinite(shares.values[i])) continue;
                if (joints.values[i] >= passed.bones.size()) refuse_joint(joints_of, joints.values[i], i / 4, skin);
                passed.weights.push_back({static_cast<rt_u32>(part.first + i / 4), joints.values[i], shares.values[i]});
                has_weight[i / 4] = true;
            }
        }
        // The node of a mesh with a skin has no effect, so these need a joint, too.
        for (size_t v = 0; v < has_weight.size(); ++v) {
            if (has_weight[v]) continue;
            passed.weights.push_back({static_cast<rt_u32>(part.first + v), 0, 1});
            ++unweighted_;
        }
    }
    passed.pass(mesh, sink_);
}

// One target at a time, because all of them together may be much larger than the file: most vertices move in few of them.
std::vector<rt_u32> Meshes::add_morphs(const Value& mesh, const Value& node, rt_u32 id, const std::vector<Part>& parts) {
    size_t count = 0;
    for (const Part& part : parts) count = std::max(count, part.primitive.list("targets").size());
    const Value weights = node.has("weights") ? node["weights"] : mesh.list("weights");
    const Value extras = mesh.has("extras") && mesh["extras"].json().is_object() ? mesh["extras"] : mesh.object("extensions");
    const bool has_names = extras.has("targetNames") && extras["targetNames"].json().is_array();
    std::vector<rt_u32> ids;
    for (size_t k = 0; k < count; ++k) {
        importers::Morph morph;
        importers::Morph::Target target;
        bool has_normals = false;
        for (const Part& part : parts) {
            const Value targets = part.primitive.list("targets");
            if (k >= targets.size()) continue;
            const auto read = [&](const char* key) {
                return targets[k].has(key) ? accessors_.floats(targets[k][key], "VEC3", part.count).values
                                           : std::vector<float>();
            };
            std::vector<float> moved = read("POSITION"), turned = read("NORMAL");
            has_normals = has_normals || !turned.empty();
            moved.resize(3 * part.count);
            turned.resize(3 * part.count);
            const auto is_zero = [](const float* v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; };
            for (size_t i = 0; i < part.count; ++i) {
                if (is_zero(&moved[3 * i]) && is_zero(&turned[3 * i])) continue;
                target.add(static_cast<rt_u32>(part.first + i), &moved[3 * i], &turned[3 * i]);
            }
        }
        constexpr float zeros[3] = {};
        if (target.vertices.empty()) target.add(0, zeros, zeros);  // an animation has a weight for it nevertheless
        if (!has_normals) target.normals.clear();
        const Value names = has_names ? extras["targetNames"] : weights;
        if (has_names && k < names.size() && names[k].json().is_string()) morph.name = names[k].text();
        morph.weight = k < weights.size() ? weights[k].number() : 0;
        morph.targets.push_back(std::move(target));
        ids.push_back(morph.pass(id, sink_));
    }
    return ids;
}

}  // namespace gltf_import
