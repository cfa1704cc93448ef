#include "../common/materials.hpp"

#include "scene.hpp"
#include "surface.hpp"

namespace fbx_import {
namespace {

// Names of properties: FBX SDK help, "FbxSurfacePhong". Up to version 5.8 they are `Diffuse`, `Emissive`, ... (measured from
// max2009_blob_5800_ascii).
Vec3 color(const Properties& p, const char* name, const char* oldest, const Vec3& otherwise) {
    return p.has(name) ? p.vector(name, otherwise) : p.vector(oldest, otherwise);
}

// Properties whose textures are maps of their own. Source of the names: FBX SDK help, "FbxSurfaceLambert".
struct Use {
    const char* property;
    rt_u32 use, space;
};
constexpr Use kUses[] = {{"EmissiveColor", RT_MAP_EMISSION, RT_SPACE_SRGB},
                         {"NormalMap", RT_MAP_NORMAL, RT_SPACE_LINEAR},
                         {"Bump", RT_MAP_NORMAL, RT_SPACE_HEIGHT}};

bool is_color(std::string_view property) {
    const std::string plain = plain_name(property);
    return property == "DiffuseColor" || plain == "basecolor" || plain == "color";  // Maya|TEX_color_map of Stingray PBS
}

void read_phong(const Properties& p, bool has_texture, bool has_emission, AlphaKeys& alpha, rt_material_desc& out) {
    // A texture replaces the colour. Its value then means nothing, because programs leave any value there.
    const Vec3 diffuse = has_texture ? Vec3{1, 1, 1} : color(p, "DiffuseColor", "Diffuse", {0.8, 0.8, 0.8});
    store_color(diffuse, has_texture ? 1 : p.number("DiffuseFactor", 1), 1, out.color);
    store_color(has_emission ? Vec3{1, 1, 1} : color(p, "EmissiveColor", "Emissive", {}), p.number("EmissiveFactor", 1), 1000,
                out.emission);
    const double strength = limited(p.number("SpecularFactor", 1), 0, 1, 1);
    store_color(color(p, "SpecularColor", "Specular", {}), strength, 1, out.specular);
    out.shininess = limited(p.number("ShininessExponent", p.number("Shininess", 0)), 1, 10000, 1);
    const Vec3 reflection = p.vector("ReflectionColor", {});
    out.reflect = limited(p.number("ReflectionFactor", 0) * std::max({reflection[0], reflection[1], reflection[2]}), 0, 1, 0);
    // The transparent share is the mean of TransparentColor times TransparencyFactor. Maya always writes 1 for the factor, so
    // the factor alone means nothing. Source: FBX SDK help, "FbxSurfaceLambert".
    const Vec3 clear = p.vector("TransparentColor", {});
    const double share = (clear[0] + clear[1] + clear[2]) / 3 * p.number("TransparencyFactor", 1);
    apply_transparency(p.number("Opacity", 1 - share), 0, 0, alpha, out);
}

// Whether a texture's picture is placed by more than texture coordinates. Source of the names: FBX SDK help, "FbxTexture" and
// "FbxFileTexture"; those with "Model" are blocks of the texture (measured from max2009_blob_6100_binary).
bool is_transformed(const Properties& p) {
    const Vec3 zero{}, one{1, 1, 1};
    return p.vector("Translation", zero) != zero || p.vector("Rotation", zero) != zero || p.vector("Scaling", one) != one ||
           p.vector("ModelUVTranslation", zero) != zero || p.vector("ModelUVScaling", one) != one || p.whole("UVSwap", 0) != 0;
}

// 0 repeat, 1 clamp. Source: FBX SDK help, "FbxTexture::EWrapMode".
rt_u32 wrap_mode(const Properties& p, const char* name) {
    return p.whole(name, 0) == 1 ? RT_WRAP_CLAMP : RT_WRAP_REPEAT;
}

}  // namespace

// UVSet: the `Name` of a layer. Source: FBX SDK help, "FbxTexture".
std::vector<std::string_view> Materials::uv_sets(uint32_t model) const {
    std::vector<std::string_view> out;
    for (const uint32_t material : of(model)) {
        const uint32_t found = texture(material, model);
        out.push_back(found == kNoObject ? std::string_view() : context_.properties(found).text("UVSet"));
    }
    return out;
}

rt_u32 Materials::id(uint32_t material, uint32_t model) {
    const auto known = ids_.find(material);
    if (known != ids_.end()) return known->second;
    const std::string& name = context_.objects[material].name;
    rt_material_desc out = rt::material(name.empty() ? nullptr : name.c_str());
    const uint32_t found = texture(material, model);
    out.texture = found == kNoObject ? RT_NONE : picture(found, RT_SPACE_SRGB);
    const std::vector<rt_map_desc> maps = maps_of(material);
    give_maps(maps, out);
    AlphaKeys alpha;
    MaterialKeys keys;
    std::vector<std::string> left_out = pictures_left_out(material);
    const Properties properties = context_.properties(material);
    const Surface surface(properties);
    if (surface.is_physical())
        surface.read(maps, out.texture != RT_NONE, keys, alpha, out, left_out);
    else
        read_phong(properties, out.texture != RT_NONE, has_map(maps, RT_MAP_EMISSION), alpha, out);
    // A texture of the transparency replaces its value. Programs connect the picture of the colour again where its alpha
    // counts.
    const uint32_t clear = transparency(material);
    if (clear != kNoObject && found != kNoObject &&
        (clear == found || (!file_of(clear).empty() && file_of(clear) == file_of(found))))
        alpha.set(AlphaKeys::blend, 1);
    else if (clear != kNoObject)
        ++transparencies_;
    alpha.give(keys);
    keys.give(out);
    if (!left_out.empty()) {
        std::string list;
        for (const std::string& what : left_out) list += (list.empty() ? "" : ", ") + what;
        context_.warn("material '" + name + "': left out " + list);
    }
    return ids_[material] = rt::id(context_.sink.material(context_.sink.ctx, &out));
}

// They lie as the texture of the colour does. A map of normals counts more than one of heights.
std::vector<rt_map_desc> Materials::maps_of(uint32_t material) {
    std::vector<rt_map_desc> maps;
    const auto add = [&](const Link& link, rt_u32 use, rt_u32 space) {
        if (has_map(maps, use) || context_.objects[link.from].kind != "Texture") return;
        rt_map_desc map = rt::map(use, picture(link.from, space));
        if (space == RT_SPACE_HEIGHT)
            map.scale = limited(context_.properties(material).number("BumpFactor", 1), -1000, 1000, 1);
        if (map.texture != RT_NONE) maps.push_back(map);
    };
    const std::vector<const Link*> links = context_.objects.below(material);
    for (const Use& use : kUses)
        for (const Link* link : links)
            if (link->property == use.property) add(*link, use.use, use.space);
    for (const Link* link : links)
        if (const SurfaceMap* map = surface_map(plain_name(link->property))) add(*link, map->use, map->space);
    return maps;
}

// Properties whose pictures mean nothing here. Those of the transparency are counted elsewhere.
std::vector<std::string> Materials::pictures_left_out(uint32_t material) const {
    std::vector<std::string> out;
    for (const Link* link : context_.objects.below(material)) {
        const std::string_view name = link->property;
        const bool is_picture = context_.objects[link->from].kind == "Texture" && !name.empty();
        const bool is_used =
            is_color(name) || name == "TransparentColor" || name == "TransparencyFactor" || surface_map(plain_name(name)) ||
            std::any_of(std::begin(kUses), std::end(kUses), [&](const Use& use) { return name == use.property; });
        if (is_picture && !is_used && std::find(out.begin(), out.end(), name) == out.end()) out.emplace_back(name);
    }
    return out;
}

// A texture hangs from the material's property, and a layered texture may be in between. In version 6 it hangs from the model,
// beside the material (measured from max2009_blob_6100_binary and the files that Blender 2.79 writes).
uint32_t Materials::texture(uint32_t material, uint32_t model) const {
    const Objects& objects = context_.objects;
    for (const Link* link : objects.below(material)) {
        const Object& object = objects[link->from];
        if (!is_color(link->property)) continue;
        if (object.kind == "Texture") return link->from;
        if (object.kind != "LayeredTexture") continue;
        for (const uint32_t layer : objects.below(link->from, "Texture")) return layer;
    }
    for (const uint32_t found : objects.below(model, "Texture")) return found;
    return kNoObject;
}

uint32_t Materials::transparency(uint32_t material) const {
    for (const Link* link : context_.objects.below(material)) {
        const bool is_clear = link->property == "TransparentColor" || link->property == "TransparencyFactor";
        if (is_clear && context_.objects[link->from].kind == "Texture") return link->from;
    }
    return kNoObject;
}

std::string_view Materials::file_of(uint32_t texture) const {
    const Node* node = context_.objects[texture].node;
    return context_.document.text(context_.document.child(node, "RelativeFilename"), 0);
}

// A texture's picture is in the Content of the Video that hangs from it, or in a file. Source: Blender developer blog.
rt_u32 Materials::picture(uint32_t texture, rt_u32 space) {
    const auto key = std::make_pair(texture, space);
    const auto known = pictures_.find(key);
    if (known != pictures_.end()) return known->second;
    const Document& document = context_.document;
    const Node* node = context_.objects[texture].node;
    if (is_transformed(context_.properties(texture))) ++transformed_;
    rt_texture_desc out{};
    out.struct_bytes = sizeof out;
    out.space = space;
    out.wrap_u = wrap_mode(context_.properties(texture), "WrapModeU");
    out.wrap_v = wrap_mode(context_.properties(texture), "WrapModeV");
    std::string content, path;
    for (const uint32_t video : context_.objects.below(texture, "Video")) {
        const Node* found = document.child(context_.objects[video].node, "Content");
        if (found && content.empty()) content = document.content(*found);
    }
    if (!content.empty()) {
        out.bytes = reinterpret_cast<const uint8_t*>(content.data());
        out.byte_count = content.size();
    } else {
        const Node* name = document.child(node, "FileName");
        path = importers::existing_picture(context_.place,
                                           {std::string(document.text(document.child(node, "RelativeFilename"), 0)),
                                            std::string(document.text(name ? name : document.child(node, "Filename"), 0))});
        if (path.empty()) return pictures_[key] = RT_NONE;
        out.path = path.c_str();
    }
    return pictures_[key] = context_.sink.texture(context_.sink.ctx, &out);
}

void Materials::report() const {
    if (transparencies_ > 0)
        context_.warn("pictures of the transparency of " + std::to_string(transparencies_) +
                      " materials are left out: they are not those of the colour");
    if (transformed_ == 0) return;
    context_.warn("the transforms of " + std::to_string(transformed_) +
                  " textures are left out: their pictures lie as the texture coordinates say");
}

}  // namespace fbx_import
