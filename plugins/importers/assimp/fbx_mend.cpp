#include "fbx_mend.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string_view>

namespace assimp_import {
namespace {

constexpr std::string_view kHelperTag = "_$AssimpFbx$_";

std::string_view name_of(const aiNode& node) {
    return {node.mName.data, node.mName.length};
}
bool is_helper(const aiNode& node) {
    return name_of(node).find(kHelperTag) != std::string_view::npos;
}
// Returns the part that a helper node stands for, for example "PreRotation"; empty for a node of the file itself.
std::string_view part_name(const aiNode& node) {
    const size_t at = name_of(node).rfind(kHelperTag);
    return at == std::string_view::npos ? std::string_view() : name_of(node).substr(at + kHelperTag.size());
}
bool is_inverse(const aiNode& node) {
    const std::string_view part = part_name(node);
    return part.substr(0, 9) == "Geometric" && part.size() > 7 && part.substr(part.size() - 7) == "Inverse";
}

FbxOutline read_outline(const std::string& path) {
    FbxOutline outline;
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat about {};
    if (file < 0 || ::fstat(file, &about) != 0 || about.st_size <= 0) {
        if (file >= 0) ::close(file);
        return outline;
    }
    // The file is mapped, not read: most of it are arrays, which are skipped.
    const size_t size = static_cast<size_t>(about.st_size);
    void* bytes = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
    ::close(file);
    if (bytes == MAP_FAILED) return outline;
    outline = read_fbx_outline({static_cast<const char*>(bytes), size});
    ::munmap(bytes, size);
    return outline;
}

aiVector3D vector(const std::array<double, 3>& v) {
    return {static_cast<ai_real>(v[0]), static_cast<ai_real>(v[1]), static_cast<ai_real>(v[2])};
}

// Rotates about x, then y, then z. Angles in degrees.
aiMatrix4x4 rotation_xyz(const std::array<double, 3>& degrees) {
    const auto radians = [&](int k) { return static_cast<ai_real>(degrees[k] * 0.017453292519943295); };
    aiMatrix4x4 x, y, z;
    aiMatrix4x4::RotationX(radians(0), x);
    aiMatrix4x4::RotationY(radians(1), y);
    aiMatrix4x4::RotationZ(radians(2), z);
    return z * y * x;
}

std::string material_name(const aiScene& scene, unsigned index) {
    aiString name;
    if (index >= scene.mNumMaterials || scene.mMaterials[index]->Get(AI_MATKEY_NAME, name) != aiReturn_SUCCESS) return {};
    return name.C_Str();
}

// Makes the material that assimp would have made.
aiMaterial* make_material(const FbxOutline::Material& from) {
    auto material = std::make_unique<aiMaterial>();
    const auto number = [&](const char* key, double otherwise) {
        const auto found = from.properties.find(key);
        return static_cast<ai_real>(found == from.properties.end() ? otherwise : found->second[0]);
    };
    const auto color = [&](const char* key, const char* factor, const char* target) {
        const auto found = from.properties.find(key);
        if (found == from.properties.end()) return;
        const ai_real scale = factor ? number(factor, 1) : 1;
        const aiColor3D value(static_cast<ai_real>(found->second[0]) * scale, static_cast<ai_real>(found->second[1]) * scale,
                              static_cast<ai_real>(found->second[2]) * scale);
        material->AddProperty(&value, 1, target, 0, 0);
    };
    const auto copy = [&](const char* key, const char* target) {
        if (!from.properties.count(key)) return;
        const ai_real value = number(key, 0);
        material->AddProperty(&value, 1, target, 0, 0);
    };
    const aiString name(from.name);
    material->AddProperty(&name, AI_MATKEY_NAME);
    color("DiffuseColor", "DiffuseFactor", "$clr.diffuse");
    color("EmissiveColor", "EmissiveFactor", "$clr.emissive");
    color("SpecularColor", nullptr, "$clr.specular");
    color("ReflectionColor", nullptr, "$clr.reflective");
    copy("SpecularFactor", "$mat.shinpercent");
    copy("ShininessExponent", "$mat.shininess");
    copy("ReflectionFactor", "$mat.reflectivity");
    copy("Opacity", "$mat.opacity");
    if (!from.texture.empty()) {
        const aiString texture(from.texture);
        material->AddProperty(&texture, AI_MATKEY_TEXTURE_DIFFUSE(0));
    }
    return material.release();
}

}  // namespace

FbxMend::FbxMend(aiScene& scene, const std::string& path) {
    if (!scene.mRootNode) return;
    outline_ = read_outline(path);
    if (!match(scene)) return;
    mend_rotations();
    mend_materials(scene);
}

// Walks through the file's models and assimp's nodes in parallel, and pairs them. Returns false at the first difference.
bool FbxMend::match(const aiScene& scene) {
    struct Step {
        aiNode* node;  // its children are paired with `models`
        const std::vector<int64_t>* models;
    };
    std::vector<Step> stack = {{scene.mRootNode, &outline_.roots}};
    while (!stack.empty()) {
        Step step = stack.back();
        stack.pop_back();
        // Skip the helper nodes that undo a node's geometric transforms for its children.
        while (step.node->mNumChildren == 1 && is_inverse(*step.node->mChildren[0])) step.node = step.node->mChildren[0];
        if (step.node->mNumChildren != step.models->size()) return false;
        for (size_t i = step.models->size(); i > 0; --i) {
            const auto model = outline_.models.find((*step.models)[i - 1]);
            if (model == outline_.models.end()) return false;
            aiNode* node = step.node->mChildren[i - 1];
            std::vector<aiNode*> helpers;
            for (; is_helper(*node) && node->mNumChildren == 1; node = node->mChildren[0]) helpers.push_back(node);
            if (name_of(*node) != model->second.name || models_.size() > outline_.models.size()) return false;
            models_[node] = &model->second;
            if (!helpers.empty()) helpers_[node] = std::move(helpers);
            stack.push_back({node, &model->second.children});
        }
    }
    // Parents first, siblings in order. assimp used this order when it chose which node gives a shared mesh its materials.
    std::vector<aiNode*> open = {scene.mRootNode};
    while (!open.empty()) {
        aiNode* node = open.back();
        open.pop_back();
        if (models_.count(node)) order_.push_back(node);
        for (unsigned i = node->mNumChildren; i > 0; --i) open.push_back(node->mChildren[i - 1]);
    }
    return true;
}

void FbxMend::mend_rotations() {
    for (aiNode* node : order_) {
        const FbxOutline::Model& model = *models_.at(node);
        const auto helpers = helpers_.find(node);
        if (helpers == helpers_.end()) {  // the node has translation, rotation and scaling in one
            if (model.rotation_active || model.rotation_order == 0) continue;
            aiMatrix4x4 translation, scaling;
            aiMatrix4x4::Translation(vector(model.translation), translation);
            aiMatrix4x4::Scaling(vector(model.scaling), scaling);
            node->mTransformation = translation * rotation_xyz(model.rotation) * scaling;
            continue;
        }
        for (aiNode* helper : helpers->second) {
            const std::string_view part = part_name(*helper);
            if (part == "GeometricRotation") helper->mTransformation = rotation_xyz(model.geometric_rotation);
            if (model.rotation_active) continue;
            if (part == "PreRotation" || part == "PostRotation") helper->mTransformation = aiMatrix4x4();
            if (part == "Rotation") helper->mTransformation = rotation_xyz(model.rotation);
        }
    }
}

// Returns the scene's index of a material of the file. Adds the material to the scene if assimp left it out.
unsigned FbxMend::material_index(aiScene& scene, int64_t id) {
    const auto known = material_indices_.find(id);
    if (known != material_indices_.end()) return known->second;
    const FbxOutline::Material& material = outline_.materials.at(id);
    const auto has_name = [&](const auto& other) { return other.second.name == material.name; };
    const bool is_unique = std::count_if(outline_.materials.begin(), outline_.materials.end(), has_name) == 1;
    for (unsigned i = 0; is_unique && i < scene.mNumMaterials; ++i) {
        if (material_name(scene, i) == material.name) return material_indices_[id] = i;
    }
    auto** grown = new aiMaterial*[scene.mNumMaterials + 1];  // owned and deleted by the scene
    std::copy(scene.mMaterials, scene.mMaterials + scene.mNumMaterials, grown);
    delete[] scene.mMaterials;
    scene.mMaterials = grown;
    scene.mMaterials[scene.mNumMaterials] = make_material(material);
    return material_indices_[id] = scene.mNumMaterials++;
}

void FbxMend::mend_materials(aiScene& scene) {
    std::map<std::vector<unsigned>, const FbxOutline::Model*> first_of;
    for (aiNode* node : order_) {
        if (node->mNumMeshes == 0) continue;
        const std::vector<unsigned> meshes(node->mMeshes, node->mMeshes + node->mNumMeshes);
        const FbxOutline::Model& model = *models_.at(node);
        const FbxOutline::Model& first = *first_of.emplace(meshes, &model).first->second;
        if (first.materials == model.materials) continue;
        std::vector<unsigned> chosen;
        for (const unsigned mesh : meshes) {
            if (mesh >= scene.mNumMeshes) return;
            unsigned index = scene.mMeshes[mesh]->mMaterialIndex;
            const std::string name = material_name(scene, index);
            // The parts of the mesh refer to slots of the node's material list. The first node's material tells which slot this
            // part uses.
            size_t slot = 0;
            while (slot < first.materials.size() && outline_.materials.at(first.materials[slot]).name != name) ++slot;
            // If the first node had no material at all, the only part of the mesh must use the first slot.
            if (first.materials.empty() && meshes.size() == 1) slot = 0;
            if (slot < model.materials.size()) index = material_index(scene, model.materials[slot]);
            chosen.push_back(index);
        }
        materials_[node] = chosen;
    }
}

std::vector<unsigned> FbxMend::materials(const aiNode& node) const {
    const auto found = materials_.find(&node);
    return found == materials_.end() ? std::vector<unsigned>() : found->second;
}

}  // namespace assimp_import
