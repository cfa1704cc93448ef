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
    {aiTextureType_BASE_COLOR, RT_MAP_COLOR, RT_SPACE_SRGB},
    {aiTextureType_DIFFUSE, RT_MAP_COLOR, RT_SPACE_SRGB},
    {aiTextureType_EMISSION_COLOR, RT_MAP_EMISSION, RT_SPACE_SRGB},
    {aiTextureType_EMISSIVE, RT_MAP_EMISSION, RT_SPACE_SRGB},
    {aiTextureType_NORMAL_CAMERA, RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {aiTextureType_NORMALS, RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {aiTextureType_HEIGHT, RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {aiTextureType_METALNESS, RT_MAP_METALLIC, RT_SPACE_LINEAR},
    {aiTextureType_DIFFUSE_ROUGHNESS, RT_MAP_ROUGHNESS, RT_SPACE_LINEAR},
    {aiTextureType_AMBIENT_OCCLUSION, RT_MAP_OCCLUSION, RT_SPACE_LINEAR},
    {aiTextureType_SPECULAR, RT_MAP_SPECULAR_COLOR, RT_SPACE_SRGB},
};
// Those that mean nothing here, with names for the warning.
constexpr std::pair<aiTextureType, const char*> kLeftOut[] = {
    {aiTextureType_AMBIENT, "ambient"},       {aiTextureType_SHININESS, "shininess"},
    {aiTextureType_REFLECTION, "reflection"}, {aiTextureType_DISPLACEMENT, "displacement"},
    {aiTextureType_LIGHTMAP, "light map"},
};

std::string picture_of(const aiMaterial& m, aiTextureType type) {
    aiString path;
    return m.GetTextureCount(type) > 0 && m.GetTexture(type, 0, &path) == aiReturn_SUCCESS ? path.C_Str() : "";
}

void add_word(std::string& list, const std::string& word) {
    list += (list.empty() ? "" : ", ") + word;
}

// The channels of coordinates that pictures of a material name, each once.
unsigned channel_of(const aiMaterial& m, aiTextureType type) {
    int channel = 0;
    const bool is_stated = m.Get(AI_MATKEY_UVWSRC(type, 0), channel) == aiReturn_SUCCESS;
    return is_stated && channel > 0 && channel < AI_MAX_NUMBER_OF_TEXTURECOORDS ? static_cast<unsigned>(channel) : 0;
}
std::vector<unsigned> channels_of(const aiMaterial& m) {
    std::vector<unsigned> out;
    const auto add = [&](aiTextureType type) {
        if (picture_of(m, type).empty()) return;
        const unsigned channel = channel_of(m, type);
        if (std::find(out.begin(), out.end(), channel) == out.end()) out.push_back(channel);
    };
    for (const Use& use : kUses) add(use.type);
    add(aiTextureType_OPACITY);
    return out;
}

// assimp's order: rotation about the middle of the picture, then scaling, then translation.
void lay(const aiMaterial& m, aiTextureType type, float (&matrix)[6]) {
    aiUVTransform t;
    if (m.Get(AI_MATKEY_UVTRANSFORM(type, 0), t) != aiReturn_SUCCESS) return;
    const float c = std::cos(t.mRotation), s = std::sin(t.mRotation), middle = 0.5f;
    const float x = middle - (c - s) * middle, y = middle - (s + c) * middle;
    const float out[6] = {c * t.mScaling.x, -s * t.mScaling.x, x * t.mScaling.x + t.mTranslation.x,
                          s * t.mScaling.y, c * t.mScaling.y,  y * t.mScaling.y + t.mTranslation.y};
    std::copy(out, out + 6, matrix);
}

// assimp's values of COLLADA materials that state none, as Lambert's (measured from assimp 5.2.4).
bool is_unstated(const aiColor3D& specular, float shininess) {
    return specular == aiColor3D(0.4f, 0.4f, 0.4f) && shininess == 10;
}

// A picture of the highlight replaces its value.
void apply_phong(const aiMaterial& m, bool has_strengths, rt_material_desc& out) {
    const aiColor3D stated = color(m, AI_MATKEY_COLOR_SPECULAR, {0, 0, 0});
    const aiColor3D specular = has_strengths                                            ? aiColor3D(1, 1, 1)
                               : is_unstated(stated, number(m, AI_MATKEY_SHININESS, 0)) ? aiColor3D(0, 0, 0)
                                                                                        : stated;
    const float strength = importers::limited(number(m, AI_MATKEY_SHININESS_STRENGTH, 1), 0, 1, 1);
    importers::store_color(specular, strength, 1, out.specular);
    out.shininess = importers::limited(number(m, AI_MATKEY_SHININESS, 0), 1, 10000, 1);
    // COLLADA stores a reflection colour beside its factor. A black colour means no reflection.
    out.reflect = importers::limited(
        number(m, AI_MATKEY_REFLECTIVITY, 0) * brightest(color(m, AI_MATKEY_COLOR_REFLECTIVE, {0, 0, 0})), 0, 1, 0);
}

}  // namespace

MaterialTable::MaterialTable(const aiScene& scene, const std::string& file, ColladaPictures pictures, const rt_scene_sink& sink)
    : scene_(scene),
      place_(file),
      pictures_(std::move(pictures)),
      sink_(sink),
      ids_(scene.mNumMaterials, RT_NONE),
      done_(scene.mNumMaterials, false) {
    if (!pictures_.differs.empty())
        rt::warn(sink_, "samplers wrap '" + pictures_.differs + "' in several ways; the first one counts");
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
    desc.texture = RT_NONE;
    std::string left_out;
    std::vector<rt_map_desc> maps = maps_of(m, left_out);
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
        apply_phong(m, importers::has_map(maps, RT_MAP_SPECULAR_COLOR), out);
    }
    importers::AlphaKeys alpha;
    const bool is_cut = !picture_of(m, aiTextureType_OPACITY).empty();
    importers::apply_transparency(is_cut ? 1 : number(m, AI_MATKEY_OPACITY, 1), number(m, AI_MATKEY_TRANSMISSION_FACTOR, 0),
                                  number(m, AI_MATKEY_REFRACTI, 0), alpha, out);
    const bool has_highlight = keys.empty() && importers::add_highlight(out, keys);
    if (importers::has_map(maps, RT_MAP_SPECULAR_COLOR) && !has_highlight) {
        importers::drop_map(maps, RT_MAP_SPECULAR_COLOR);
        add_word(left_out, "specular");
    }
    if (is_cut) read_transparency(m, maps, alpha, left_out);
    alpha.give(keys);
    keys.give(out);
    importers::give_maps(maps, out);
    for (const auto& [type, word] : kLeftOut)
        if (!picture_of(m, type).empty()) add_word(left_out, word);
    if (pictures_.shininess.count(name.C_Str())) add_word(left_out, "shininess");  // assimp says nothing of it
    std::string text = left_out.empty() ? "" : "the pictures of " + left_out;
    if (pictures_.hues.count(name.C_Str())) add_word(text, "the hue of the transparency");
    if (!text.empty()) rt::warn(sink_, "material '" + std::string(name.C_Str()) + "': left out " + text);
    return ids_[material] = rt::id(sink_.material(sink_.ctx, &desc));
}

// A is the picture's alpha, L its brightness, t the factor. A_ONE: A t of the surface is there. RGB_ZERO: 1 - L t. RGB_ONE: L
// t. Source: COLLADA 1.5.0, "transparent". Other formats than COLLADA do not say which; there only the alpha of the colour's
// picture is certain.
void MaterialTable::read_transparency(const aiMaterial& m, std::vector<rt_map_desc>& maps, importers::AlphaKeys& alpha,
                                      std::string& left_out) {
    const std::string picture = picture_of(m, aiTextureType_OPACITY);
    const auto stated = pictures_.transparencies.find(file_name(picture));
    const bool is_collada = stated != pictures_.transparencies.end();
    const Transparency how = is_collada ? stated->second : Transparency{"A_ONE", 1};
    const bool is_of_color =
        picture == picture_of(m, aiTextureType_BASE_COLOR) || picture == picture_of(m, aiTextureType_DIFFUSE);
    constexpr std::pair<std::string_view, rt_u32> kSpaces[] = {
        {"A_ONE", RT_SPACE_ALPHA}, {"RGB_ONE", RT_SPACE_LINEAR}, {"RGB_ZERO", RT_SPACE_CLEARNESS}};
    const auto space = std::find_if(std::begin(kSpaces), std::end(kSpaces), [&](const auto& s) { return s.first == how.mode; });
    const bool is_understood = space != std::end(kSpaces) && (how.mode != "RGB_ZERO" || how.factor == 1);
    if (is_of_color && how.mode == "A_ONE")
        alpha.set(importers::AlphaKeys::blend, how.factor);
    else if (is_collada && is_understood) {
        const rt_map_desc opacity = map(m, aiTextureType_OPACITY, RT_MAP_OPACITY, space->second);
        if (opacity.texture == RT_NONE) return;
        maps.push_back(opacity);
        alpha.set(importers::AlphaKeys::blend, how.mode == "RGB_ZERO" ? 1 : how.factor);
    } else {
        add_word(left_out, "transparency");
    }
}

Channels MaterialTable::channels(unsigned material) const {
    if (material >= scene_.mNumMaterials || !scene_.mMaterials[material]) return {};
    std::vector<unsigned> found = channels_of(*scene_.mMaterials[material]);
    found.resize(2, found.empty() ? 0 : found[0]);
    return {found[0], found[1]};
}

std::vector<rt_map_desc> MaterialTable::maps_of(const aiMaterial& material, std::string& left_out) {
    std::vector<rt_map_desc> maps;
    for (const Use& use : kUses) {
        if (importers::has_map(maps, use.use) || picture_of(material, use.type).empty()) continue;
        const rt_map_desc found = map(material, use.type, use.use, use.space);
        if (found.texture != RT_NONE) maps.push_back(found);
    }
    if (channels_of(material).size() > 2) add_word(left_out, "a third set of coordinates, which lie in the first");
    return maps;
}

rt_map_desc MaterialTable::map(const aiMaterial& material, aiTextureType type, rt_u32 use, rt_u32 space) {
    rt_map_desc out = rt::map(use, texture(material, type, space));
    const std::vector<unsigned> channels = channels_of(material);
    out.set = channels.size() > 1 && channel_of(material, type) == channels[1] ? 1 : 0;
    lay(material, type, out.matrix);
    return out;
}

rt_u32 MaterialTable::texture(const aiMaterial& material, aiTextureType type, rt_u32 space) {
    const std::string path = picture_of(material, type);
    if (path.empty()) return RT_NONE;
    const auto stated = pictures_.wraps.find(file_name(path));
    if (stated != pictures_.wraps.end()) return add_texture(path, stated->second.first, stated->second.second, space);
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
