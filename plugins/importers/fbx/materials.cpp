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
                         {"Bump", RT_MAP_NORMAL, RT_SPACE_HEIGHT},
                         {"SpecularColor", RT_MAP_SPECULAR_COLOR, RT_SPACE_SRGB}};

bool is_color(std::string_view property) {
    const std::string plain = plain_name(property);
    return property == "DiffuseColor" || plain == "basecolor" || plain == "color";  // Maya|TEX_color_map of Stingray PBS
}

void read_phong(const Properties& p, std::vector<rt_map_desc>& maps, MaterialKeys& keys, AlphaKeys& alpha,
                rt_material_desc& out, std::vector<std::string>& left_out) {
    // A texture replaces the colour. Its value then means nothing, because programs leave any value there.
    const bool has_texture = has_map(maps, RT_MAP_COLOR), has_emission = has_map(maps, RT_MAP_EMISSION),
               has_strengths = has_map(maps, RT_MAP_SPECULAR_COLOR);
    const Vec3 diffuse = has_texture ? Vec3{1, 1, 1} : color(p, "DiffuseColor", "Diffuse", {0.8, 0.8, 0.8});
    store_color(diffuse, has_texture ? 1 : p.number("DiffuseFactor", 1), 1, out.color);
    store_color(has_emission ? Vec3{1, 1, 1} : color(p, "EmissiveColor", "Emissive", {}), p.number("EmissiveFactor", 1), 1000,
                out.emission);
    const double strength = limited(p.number("SpecularFactor", 1), 0, 1, 1);
    store_color(has_strengths ? Vec3{1, 1, 1} : color(p, "SpecularColor", "Specular", {}), strength, 1, out.specular);
    out.shininess = limited(p.number("ShininessExponent", p.number("Shininess", 0)), 1, 10000, 1);
    const Vec3 reflection = p.vector("ReflectionColor", {});
    out.reflect = limited(p.number("ReflectionFactor", 0) * std::max({reflection[0], reflection[1], reflection[2]}), 0, 1, 0);
    // The transparent share is the mean of TransparentColor times TransparencyFactor. Maya always writes 1 for the factor, so
    // the factor alone means nothing. Source: FBX SDK help, "FbxSurfaceLambert".
    const Vec3 clear = p.vector("TransparentColor", {});
    const double share = (clear[0] + clear[1] + clear[2]) / 3 * p.number("TransparencyFactor", 1);
    apply_transparency(p.number("Opacity", 1 - share), 0, 0, alpha, out);
    if (share > 0 && has_hue(clear)) left_out.emplace_back("hue of TransparentColor");
    if (add_highlight(out, keys) || !has_strengths) return;
    drop_map(maps, RT_MAP_SPECULAR_COLOR);
    left_out.emplace_back("SpecularColor");
}

// The place on the picture of a point of the surface: UVSwap, scaling and rotation about their pivots, then translation, with
// (0, 0) at the bottom left. Source of the names: FBX SDK help, "FbxTexture" and "FbxFileTexture"; those with "Model" are
// blocks of the texture (measured from max2009_blob_6100_binary), and assimp's issue 2043 tells that programs leave them alone.
// 3ds Max writes its tiling as Scaling and 0.5 - (offset + 0.5) tiling as Translation (comment in Cocos' FBX-glTF-conv).
void lay(const Properties& p, rt_map_desc& out) {
    const Vec3 zero{}, one{1, 1, 1}, turn = p.vector("TextureRotationPivot", zero),
                                     pivot = p.vector("TextureScalingPivot", zero);
    const Vec3 scale = p.vector("Scaling", one), offset = p.vector("Translation", zero), rotation = p.vector("Rotation", zero);
    const Vec3 first_scale = p.vector("ModelUVScaling", one), first_offset = p.vector("ModelUVTranslation", zero);
    const double c = std::cos(rotation[2] * kRadPerDegree), s = std::sin(rotation[2] * kRadPerDegree);
    const bool is_swapped = p.whole("UVSwap", 0) != 0;
    const auto place = [&](double u, double v) -> std::array<double, 2> {
        u = u * first_scale[0] + first_offset[0], v = v * first_scale[1] + first_offset[1];
        if (is_swapped) std::swap(u, v);
        u = (u - pivot[0]) * scale[0] + pivot[0] - turn[0], v = (v - pivot[1]) * scale[1] + pivot[1] - turn[1];
        return {c * u - s * v + turn[0] + offset[0], s * u + c * v + turn[1] + offset[1]};
    };
    const std::array<double, 2> origin = place(0, 0), along_u = place(1, 0), along_v = place(0, 1);
    for (size_t k = 0; k < 2; ++k) {
        out.matrix[3 * k] = static_cast<float>(along_u[k] - origin[k]);
        out.matrix[3 * k + 1] = static_cast<float>(along_v[k] - origin[k]);
        out.matrix[3 * k + 2] = static_cast<float>(origin[k]);
    }
}
// The angles about u and v tilt the picture out of its plane.
bool is_tilted(const Properties& p) {
    const Vec3 rotation = p.vector("Rotation", Vec3{});
    return rotation[0] != 0 || rotation[1] != 0;
}

// 0 repeat, 1 clamp. Source: FBX SDK help, "FbxTexture::EWrapMode".
rt_u32 wrap_mode(const Properties& p, const char* name) {
    return p.whole(name, 0) == 1 ? RT_WRAP_CLAMP : RT_WRAP_REPEAT;
}

}  // namespace

// UVSet: the `Name` of a layer; `default` is that of new textures. Source: FBX SDK help, "FbxTexture".
std::string_view Materials::uv_set(uint32_t texture) const {
    const std::string_view name = context_.properties(texture).text("UVSet");
    return name == "default" ? std::string_view() : name;
}

UvSets Materials::sets_of(const std::vector<UsedTexture>& used) const {
    UvSets sets;
    for (const UsedTexture& of : used) {
        const std::string_view name = uv_set(of.texture);
        if (sets.size() < kMostUvSets && std::find(sets.begin(), sets.end(), name) == sets.end()) sets.push_back(name);
    }
    if (sets.empty()) sets.emplace_back();
    return sets;
}

std::vector<UvSets> Materials::uv_sets(uint32_t model) const {
    std::vector<UvSets> out;
    for (const uint32_t material : of(model)) out.push_back(sets_of(used(material, model)));
    return out;
}

rt_u32 Materials::id(uint32_t material, uint32_t model) {
    const auto known = ids_.find(material);
    if (known != ids_.end()) return known->second;
    const std::string& name = context_.objects[material].name;
    rt_material_desc out = rt::material(name.empty() ? nullptr : name.c_str());
    std::vector<std::string> left_out = pictures_left_out(material);
    std::vector<rt_map_desc> maps = maps_of(material, used(material, model), left_out);
    AlphaKeys alpha;
    MaterialKeys keys;
    const Properties properties = context_.properties(material);
    const Surface surface(properties);
    if (surface.is_physical())
        surface.read(maps, has_map(maps, RT_MAP_COLOR), keys, alpha, out, left_out);
    else
        read_phong(properties, maps, keys, alpha, out, left_out);
    give_maps(maps, out);
    // A texture of the transparency replaces its value. Programs connect the picture of the colour again where its alpha
    // counts.
    const uint32_t clear = transparency(material), found = texture(material, model);
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

// The texture of the colour, then each other use once. A map of normals counts more than one of heights.
std::vector<UsedTexture> Materials::used(uint32_t material, uint32_t model) const {
    std::vector<UsedTexture> out;
    const auto add = [&](uint32_t texture, rt_u32 use, rt_u32 space) {
        const bool is_new = std::none_of(out.begin(), out.end(), [&](const UsedTexture& known) { return known.use == use; });
        if (is_new && texture != kNoObject && context_.objects[texture].kind == "Texture") out.push_back({texture, use, space});
    };
    add(texture(material, model), RT_MAP_COLOR, RT_SPACE_SRGB);
    const std::vector<const Link*> links = context_.objects.below(material);
    for (const Use& use : kUses)
        for (const Link* link : links)
            if (link->property == use.property && takes(material, use.use)) add(link->from, use.use, use.space);
    for (const Link* link : links)
        if (const SurfaceMap* map = surface_map(plain_name(link->property))) add(link->from, map->use, map->space);
    return out;
}

// Physically based materials have strengths of reflections by names of their own.
bool Materials::takes(uint32_t material, rt_u32 use) const {
    return use != RT_MAP_SPECULAR_COLOR || !Surface(context_.properties(material)).is_physical();
}

std::vector<rt_map_desc> Materials::maps_of(uint32_t material, const std::vector<UsedTexture>& used,
                                            std::vector<std::string>& left_out) {
    std::vector<rt_map_desc> maps;
    const UvSets sets = sets_of(used);
    for (const UsedTexture& of : used) {
        const Properties properties = context_.properties(of.texture);
        rt_map_desc map = rt::map(of.use, picture(of.texture, of.space));
        if (map.texture == RT_NONE) continue;
        const auto set = std::find(sets.begin(), sets.end(), uv_set(of.texture));
        const std::string label = "of the texture '" + context_.objects[of.texture].name + "'";
        if (set == sets.end()) left_out.push_back("the third set of coordinates, " + label);
        if (is_tilted(properties)) left_out.push_back("the rotation about u and v " + label);
        map.set = set == sets.end() ? 0 : static_cast<rt_u32>(set - sets.begin());
        lay(properties, map);
        if (of.space == RT_SPACE_HEIGHT)
            map.scale = limited(context_.properties(material).number("BumpFactor", 1), -1000, 1000, 1);
        maps.push_back(map);
    }
    return maps;
}

// Properties whose pictures mean nothing here. Those of the transparency are counted elsewhere.
std::vector<std::string> Materials::pictures_left_out(uint32_t material) const {
    std::vector<std::string> out;
    for (const Link* link : context_.objects.below(material)) {
        const std::string_view name = link->property;
        const bool is_picture = context_.objects[link->from].kind == "Texture" && !name.empty();
        const bool is_used = is_color(name) || name == "TransparentColor" || name == "TransparencyFactor" ||
                             surface_map(plain_name(name)) ||
                             std::any_of(std::begin(kUses), std::end(kUses),
                                         [&](const Use& use) { return name == use.property && takes(material, use.use); });
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
}

}  // namespace fbx_import
