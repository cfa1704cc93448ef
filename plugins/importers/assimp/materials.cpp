#include "materials.hpp"

#include <assimp/material.h>

#include <algorithm>
#include <cmath>

#include "../common/materials.hpp"
#include "rt_plugin.hpp"

namespace assimp_import {
namespace {

float number(const aiMaterial& m, const char* key, unsigned type, unsigned index, float otherwise) {
    ai_real value = otherwise;
    return m.Get(key, type, index, value) == aiReturn_SUCCESS && std::isfinite(value) ? value : otherwise;
}

aiColor3D color(const aiMaterial& m, const char* key, unsigned type, unsigned index, const aiColor3D& otherwise) {
    aiColor3D value = otherwise;
    return m.Get(key, type, index, value) == aiReturn_SUCCESS ? value : otherwise;
}

float brightest(const aiColor3D& c) {
    return std::max({c.r, c.g, c.b});
}

// What pictures are for. assimp calls the bumps of COLLADA, which are either, normals; the host tells normals from heights.
struct Use {
    aiTextureType type;
    rt_u32 use, space;
};
constexpr Use kUses[] = {
    {aiTextureType_EMISSION_COLOR, RT_MAP_EMISSION, RT_SPACE_SRGB},
    {aiTextureType_EMISSIVE, RT_MAP_EMISSION, RT_SPACE_SRGB},
    {aiTextureType_NORMAL_CAMERA, RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {aiTextureType_NORMALS, RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {aiTextureType_HEIGHT, RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {aiTextureType_METALNESS, RT_MAP_METALLIC, RT_SPACE_LINEAR},
    {aiTextureType_DIFFUSE_ROUGHNESS, RT_MAP_ROUGHNESS, RT_SPACE_LINEAR},
    {aiTextureType_AMBIENT_OCCLUSION, RT_MAP_OCCLUSION, RT_SPACE_LINEAR},
};
// Those that mean nothing here, with names for the warning.
constexpr std::pair<aiTextureType, const char*> kLeftOut[] = {
    {aiTextureType_AMBIENT, "ambient"},           {aiTextureType_SPECULAR, "specular"},
    {aiTextureType_SHININESS, "shininess"},       {aiTextureType_REFLECTION, "reflection"},
    {aiTextureType_DISPLACEMENT, "displacement"}, {aiTextureType_LIGHTMAP, "light map"},
};

std::string picture_of(const aiMaterial& m, aiTextureType type) {
    aiString path;
    return m.GetTextureCount(type) > 0 && m.GetTexture(type, 0, &path) == aiReturn_SUCCESS ? path.C_Str() : "";
}

void apply_phong(const aiMaterial& m, rt_material_desc& out) {
    const aiColor3D specular = color(m, AI_MATKEY_COLOR_SPECULAR, {0, 0, 0});
    const float strength = importers::limited(number(m, AI_MATKEY_SHININESS_STRENGTH, 1), 0, 1, 1);
    importers::store_color(specular, strength, 1, out.specular);
    out.shininess = importers::limited(number(m, AI_MATKEY_SHININESS, 0), 1, 10000, 1);
    // COLLADA stores a reflection colour beside its factor. A black colour means no reflection.
    out.reflect = importers::limited(
        number(m, AI_MATKEY_REFLECTIVITY, 0) * brightest(color(m, AI_MATKEY_COLOR_REFLECTIVE, {0, 0, 0})), 0, 1, 0);
}

}  // namespace

MaterialTable::MaterialTable(const aiScene& scene, const std::string& file, ColladaWraps wraps, const rt_scene_sink& sink)
    : scene_(scene),
      place_(file),
      wraps_(std::move(wraps)),
      sink_(sink),
      ids_(scene.mNumMaterials, RT_NONE),
      done_(scene.mNumMaterials, false) {
    if (!wraps_.differs.empty())
        rt::warn(sink_, "samplers wrap '" + wraps_.differs + "' in several ways; the first one counts");
}

rt_u32 MaterialTable::id(unsigned material) {
    if (material >= scene_.mNumMaterials || !scene_.mMaterials[material]) return RT_NONE;
    if (done_[material]) return ids_[material];
    done_[material] = true;
    const aiMaterial& m = *scene_.mMaterials[material];

    rt_material_desc desc{};
    desc.struct_bytes = sizeof desc;
    aiString name;
    if (m.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS && name.length > 0) desc.name = name.C_Str();
    // assimp adds a material where the file has none. The host's default material takes its place.
    if (std::string(name.C_Str()) == AI_DEFAULT_MATERIAL_NAME) return RT_NONE;
    rt_material_desc& out = desc;
    std::string color_picture, left_out;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
        if (color_picture.empty()) out.texture = texture(m, type, RT_SPACE_SRGB);
        if (color_picture.empty()) color_picture = picture_of(m, type);
    }
    std::vector<rt_map_desc> maps = maps_of(m);
    aiColor3D base = color(m, AI_MATKEY_COLOR_DIFFUSE, {0.8f, 0.8f, 0.8f});
    base = color(m, AI_MATKEY_BASE_COLOR, base);
    importers::store_color(base, 1, 1, out.color);
    // A picture replaces the value.
    const aiColor3D emission =
        importers::has_map(maps, RT_MAP_EMISSION) ? aiColor3D(1, 1, 1) : color(m, AI_MATKEY_COLOR_EMISSIVE, {0, 0, 0});
    const float intensity = importers::limited(number(m, AI_MATKEY_EMISSIVE_INTENSITY, 1), 0, 1000, 1);
    importers::store_color(emission, intensity, 1000, out.emission);
    importers::MaterialKeys keys;
    ai_real metallic = 0;
    if (m.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == aiReturn_SUCCESS) {
        keys.set("model", importers::gltf_model);
        keys.set("metallic", importers::has_map(maps, RT_MAP_METALLIC) ? 1 : metallic);
        keys.set("roughness", importers::has_map(maps, RT_MAP_ROUGHNESS) ? 1 : number(m, AI_MATKEY_ROUGHNESS_FACTOR, 1));
    } else {
        apply_phong(m, out);
    }
    importers::AlphaKeys alpha;
    const std::string cut = picture_of(m, aiTextureType_OPACITY);
    importers::apply_transparency(cut.empty() ? number(m, AI_MATKEY_OPACITY, 1) : 1,
                                  number(m, AI_MATKEY_TRANSMISSION_FACTOR, 0), number(m, AI_MATKEY_REFRACTI, 0), alpha, out);
    // With A_ONE it is the picture's alpha that counts, which only that of the colour has here. RGB_ZERO would be one minus
    // its brightness; assimp tells it by a transparent colour.
    aiColor3D transparent;
    if (!cut.empty() && cut == color_picture && m.Get(AI_MATKEY_COLOR_TRANSPARENT, transparent) != aiReturn_SUCCESS)
        alpha.set(importers::AlphaKeys::blend, 1);
    else if (!cut.empty())
        left_out = "transparency";
    alpha.give(keys);
    keys.give(out);
    importers::give_maps(maps, out);
    for (const auto& [type, word] : kLeftOut)
        if (!picture_of(m, type).empty()) left_out += (left_out.empty() ? "" : ", ") + std::string(word);
    if (!left_out.empty())
        rt::warn(sink_, "material '" + std::string(name.C_Str()) + "': left out the pictures of " + left_out);
    return ids_[material] = rt::id(sink_.material(sink_.ctx, &desc));
}

TextureMapping MaterialTable::mapping(unsigned material) const {
    TextureMapping mapping;
    if (material >= scene_.mNumMaterials || !scene_.mMaterials[material]) return mapping;
    const aiMaterial& m = *scene_.mMaterials[material];
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
        if (m.GetTextureCount(type) == 0) continue;
        int channel = 0;
        if (m.Get(AI_MATKEY_UVWSRC(type, 0), channel) == aiReturn_SUCCESS && channel > 0 &&
            channel < AI_MAX_NUMBER_OF_TEXTURECOORDS) {
            mapping.channel = static_cast<unsigned>(channel);
        }
        aiUVTransform t;
        if (m.Get(AI_MATKEY_UVTRANSFORM(type, 0), t) == aiReturn_SUCCESS) {
            mapping.transform = t;
            mapping.has_transform =
                t.mTranslation.x != 0 || t.mTranslation.y != 0 || t.mScaling.x != 1 || t.mScaling.y != 1 || t.mRotation != 0;
        }
        return mapping;
    }
    return mapping;
}

// They lie as the picture of the colour does.
std::vector<rt_map_desc> MaterialTable::maps_of(const aiMaterial& material) {
    std::vector<rt_map_desc> maps;
    for (const Use& use : kUses) {
        if (importers::has_map(maps, use.use)) continue;
        const rt_map_desc map = rt::map(use.use, texture(material, use.type, use.space));
        if (map.texture != RT_NONE) maps.push_back(map);
    }
    return maps;
}

rt_u32 MaterialTable::texture(const aiMaterial& material, aiTextureType type, rt_u32 space) {
    const std::string path = picture_of(material, type);
    if (path.empty()) return RT_NONE;
    const auto stated = wraps_.of_picture.find(file_name(path));
    if (stated != wraps_.of_picture.end()) return add_texture(path, stated->second.first, stated->second.second, space);
    return add_texture(path, wrap_mode(material, AI_MATKEY_MAPPINGMODE_U(type, 0)),
                       wrap_mode(material, AI_MATKEY_MAPPINGMODE_V(type, 0)), space);
}

// aiTextureMapMode.
rt_u32 MaterialTable::wrap_mode(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
    int mode = aiTextureMapMode_Wrap;
    material.Get(key, type, index, mode);
    if (mode == aiTextureMapMode_Wrap) return RT_WRAP_REPEAT;
    if (mode == aiTextureMapMode_Mirror) return RT_WRAP_MIRROR;
    if (mode == aiTextureMapMode_Decal && !warned_of_decals_)
        rt::warn(sink_, "outside of their pictures, decals show the material's colour; here they show their border");
    warned_of_decals_ = warned_of_decals_ || mode == aiTextureMapMode_Decal;
    return RT_WRAP_CLAMP;
}

rt_u32 MaterialTable::add_texture(const std::string& reference, rt_u32 wrap_u, rt_u32 wrap_v, rt_u32 space) {
    const auto [known, is_new] = textures_.insert({{reference, wrap_u, wrap_v, space}, RT_NONE});
    if (!is_new) return known->second;
    rt_texture_desc desc{};
    desc.struct_bytes = sizeof desc;
    desc.wrap_u = wrap_u;
    desc.wrap_v = wrap_v;
    desc.space = space;
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(reference.c_str()))
        return known->second = embedded_texture(*embedded, desc);
    const std::string path = importers::existing_picture(place_, {reference});
    desc.path = path.c_str();
    return known->second = sink_.texture(sink_.ctx, &desc);
}

rt_u32 MaterialTable::embedded_texture(const aiTexture& texture, rt_texture_desc& desc) {
    if (!texture.pcData || texture.mWidth == 0) return RT_NONE;
    if (texture.mHeight == 0) {  // an encoded picture; mWidth is its size in bytes
        desc.bytes = reinterpret_cast<const uint8_t*>(texture.pcData);
        desc.byte_count = texture.mWidth;
        return sink_.texture(sink_.ctx, &desc);
    }
    const size_t count = size_t(texture.mWidth) * texture.mHeight;
    std::vector<uint8_t> rgba(4 * count);
    for (size_t i = 0; i < count; ++i) {
        const aiTexel& t = texture.pcData[i];
        const uint8_t texel[4] = {t.r, t.g, t.b, t.a};
        std::copy(texel, texel + 4, &rgba[4 * i]);
    }
    desc.bytes = rgba.data();
    desc.byte_count = rgba.size();
    desc.width = texture.mWidth;
    desc.height = texture.mHeight;
    return sink_.texture(sink_.ctx, &desc);
}

}  // namespace assimp_import
