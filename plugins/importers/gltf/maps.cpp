#include "maps.hpp"

#include <algorithm>
#include <cmath>

#include "rt_plugin.hpp"
#include "tolerant.hpp"
#include "uri.hpp"

namespace gltf_import {
namespace {

// A property of a material that is a texture. Sources: glTF 2.0, section 3.9, and the README of each extension.
struct Use {
    rt_u32 use;
    const char *extension, *object;  // NULL: the material itself
    const char* property;
    rt_u32 space = RT_SPACE_LINEAR;
    const char* scale = nullptr;  // the member of the texture's description that is rt_map_desc::scale
};
constexpr const char *kGloss = "KHR_materials_pbrSpecularGlossiness", *kGlossTexture = "specularGlossinessTexture";
// Of two with the same use the first counts.
constexpr Use kUses[] = {
    {RT_MAP_COLOR, kGloss, nullptr, "diffuseTexture", RT_SPACE_SRGB},
    {RT_MAP_COLOR, nullptr, "pbrMetallicRoughness", "baseColorTexture", RT_SPACE_SRGB},
    {RT_MAP_EMISSION, nullptr, nullptr, "emissiveTexture", RT_SPACE_SRGB},
    {RT_MAP_NORMAL, nullptr, nullptr, "normalTexture", RT_SPACE_LINEAR, "scale"},
    {RT_MAP_OCCLUSION, nullptr, nullptr, "occlusionTexture", RT_SPACE_LINEAR, "strength"},
    {RT_MAP_METALLIC_ROUGHNESS, nullptr, "pbrMetallicRoughness", "metallicRoughnessTexture"},
    {RT_MAP_TRANSMISSION, "KHR_materials_transmission", nullptr, "transmissionTexture"},
    {RT_MAP_THICKNESS, "KHR_materials_volume", nullptr, "thicknessTexture"},
    {RT_MAP_CLEARCOAT, "KHR_materials_clearcoat", nullptr, "clearcoatTexture"},
    {RT_MAP_CLEARCOAT_ROUGHNESS, "KHR_materials_clearcoat", nullptr, "clearcoatRoughnessTexture"},
    {RT_MAP_CLEARCOAT_NORMAL, "KHR_materials_clearcoat", nullptr, "clearcoatNormalTexture", RT_SPACE_LINEAR, "scale"},
    {RT_MAP_SPECULAR, "KHR_materials_specular", nullptr, "specularTexture"},
    {RT_MAP_SPECULAR_COLOR, kGloss, nullptr, kGlossTexture, RT_SPACE_SRGB},
    {RT_MAP_SPECULAR_COLOR, "KHR_materials_specular", nullptr, "specularColorTexture", RT_SPACE_SRGB},
    {RT_MAP_SHEEN_COLOR, "KHR_materials_sheen", nullptr, "sheenColorTexture", RT_SPACE_SRGB},
    {RT_MAP_SHEEN_ROUGHNESS, "KHR_materials_sheen", nullptr, "sheenRoughnessTexture"},
    {RT_MAP_ANISOTROPY, "KHR_materials_anisotropy", nullptr, "anisotropyTexture"},
    {RT_MAP_IRIDESCENCE, "KHR_materials_iridescence", nullptr, "iridescenceTexture"},
    {RT_MAP_IRIDESCENCE_THICKNESS, "KHR_materials_iridescence", nullptr, "iridescenceThicknessTexture"},
};

Value owner_of(const Value& material, const Use& use) {
    if (use.extension) return material.object("extensions").object(use.extension);
    return use.object ? material.object(use.object) : material;
}

// Calls body(use, description of the texture) for each texture of a material.
template <class Body>
void each_use(const Value& material, const Body& body) {
    std::vector<rt_u32> seen;
    for (const Use& use : kUses) {
        const Value owner = owner_of(material, use);
        if (!owner.has(use.property) || std::find(seen.begin(), seen.end(), use.use) != seen.end()) continue;
        seen.push_back(use.use);
        body(use, owner[use.property]);
    }
}

uint64_t set_of(const Value& info) {
    const Value transform = info.object("extensions").object("KHR_texture_transform");
    return transform.count("texCoord", info.count("texCoord", 0));
}

// KHR_texture_transform: translation * rotation * scale, counter-clockwise, of coordinates whose v points down. The host's v
// points up from the lower edge: v' = 1 - v on both sides.
void read_transform(const Value& info, rt_map_desc& out) {
    const Value transform = info.object("extensions").object("KHR_texture_transform");
    const std::array<double, 2> offset = transform.numbers<2>("offset", {0, 0}), scale = transform.numbers<2>("scale", {1, 1});
    const double angle = transform.number("rotation", 0), c = std::cos(angle), s = std::sin(angle);
    const double m[6] = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
    const double up[6] = {m[0], -m[1], m[1] + m[2], -m[3], m[4], 1 - m[4] - m[5]};
    for (int k = 0; k < 6; ++k) out.matrix[k] = static_cast<float>(up[k]);
}

// Paths out of the folder are passed on as they are: the host finds pictures by their names alone, too.
std::string image_path(const Value& uri, const std::string& folder) {
    try {
        return file_of_uri(uri, folder);
    } catch (const Error&) {
        return percent_decoded(uri.text());
    }
}

}  // namespace

Maps::Maps(const Document& document, Accessors& accessors, const rt_scene_sink& sink)
    : accessors_(accessors),
      folder_(document.folder()),
      textures_(spared_list(document, "textures", sink)),
      images_(spared_list(document, "images", sink)),
      samplers_(spared_list(document, "samplers", sink)),
      sink_(sink) {}

TextureSets Maps::sets(const Value& material) const {
    TextureSets sets;
    try {
        each_use(material, [&](const Use&, const Value& info) {
            try {
                sets.push_back(set_of(info));
            } catch (const Error&) {  // read_maps() says so
            }
        });
    } catch (const Error&) {
    }
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    if (sets.empty()) sets.push_back(0);
    if (sets.size() > kMostSets) sets.resize(kMostSets);
    return sets;
}

std::vector<rt_map_desc> Maps::read(const Value& material, bool emits, std::vector<std::string>& left_out) {
    const TextureSets known = sets(material);
    std::vector<rt_map_desc> maps;
    each_use(material, [&](const Use& use, const Value& info) {
        if (use.use == RT_MAP_EMISSION && !emits) return;
        spared(sink_, "the material stays without that texture", [&] {
            std::string why_not;
            rt_map_desc out = rt::map(use.use, texture(info, use.space, why_not));
            if (!why_not.empty()) left_out.push_back(use.property + why_not);
            if (use.property == kGlossTexture) left_out.push_back("the alpha of " + std::string(kGlossTexture));
            spared(sink_, "the texture lies as the coordinates say", [&] { read_transform(info, out); });
            spared(sink_, "the first set is taken", [&] {
                const auto at = std::find(known.begin(), known.end(), set_of(info));
                if (at == known.end())
                    info["texCoord"].refuse("one of the " + std::to_string(kMostSets) + " sets that a material may use");
                out.set = static_cast<rt_u32>(at - known.begin());
            });
            if (use.scale) out.scale = static_cast<float>(info.number(use.scale, 1));
            if (out.texture != RT_NONE) maps.push_back(out);
        });
    });
    return maps;
}

// why_not: what follows the name of a texture that is left out.
rt_u32 Maps::texture(const Value& info, rt_u32 space, std::string& why_not) {
    if (!info.has("index")) return RT_NONE;
    const Value texture = textures_[info["index"].index(textures_)];
    const auto image = texture.index("source", images_);
    if (!image) {
        // An extension may name an image of a kind that the host does not read: KTX, WebP, AVIF.
        const Value extensions = texture.object("extensions");
        for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif"})
            if (extensions.has(name)) why_not = std::string(" (its picture is of ") + name + " alone)";
        if (why_not.empty()) why_not = " (" + texture.path() + " has no 'source')";
        return RT_NONE;
    }
    rt_texture_desc look{};
    look.struct_bytes = sizeof look;
    look.space = space;
    spared(sink_, "the texture repeats", [&] {
        const auto sampler = texture.index("sampler", samplers_);
        if (!sampler) return;
        constexpr uint64_t kNearest = 9728;
        look.wrap_u = wrap_mode(samplers_[*sampler], "wrapS");
        look.wrap_v = wrap_mode(samplers_[*sampler], "wrapT");
        if (samplers_[*sampler].count("magFilter", 0) == kNearest) look.filter = RT_FILTER_NEAREST;
    });
    const auto known = ids_.insert({{*image, look.wrap_u, look.wrap_v, space, look.filter}, RT_NONE});
    rt_u32& id = known.first->second;
    if (known.second) spared(sink_, "the image is left out", [&] { id = add_image(images_[*image], look); });
    return id;
}

rt_u32 Maps::wrap_mode(const Value& sampler, const char* key) const {
    constexpr std::pair<uint64_t, rt_u32> kModes[] = {{10497, RT_WRAP_REPEAT}, {33071, RT_WRAP_CLAMP}, {33648, RT_WRAP_MIRROR}};
    const uint64_t code = sampler.count(key, 10497);
    for (const auto& [known, mode] : kModes)
        if (known == code) return mode;
    sampler[key].refuse("10497 (repeat), 33071 (clamp to edge) or 33648 (mirrored repeat)");
}

rt_u32 Maps::add_image(const Value& image, rt_texture_desc out) {
    const Image found(image, accessors_, folder_);
    out.name = found.look.name, out.path = found.look.path;
    out.bytes = found.look.bytes, out.byte_count = found.look.byte_count;
    return sink_.texture(sink_.ctx, &out);
}

Image::Image(const Value& image, Accessors& accessors, const std::string& folder) {
    look.struct_bytes = sizeof look;
    name_ = image.has("name") ? image["name"].text() : "";
    if (!name_.empty()) look.name = name_.c_str();
    std::string_view bytes;
    if (image.has("bufferView")) {
        bytes = accessors.view(image["bufferView"]);
    } else if (const Value uri = image["uri"]; decode_data_uri(uri, content_)) {
        bytes = content_;
    } else {
        // The host decides what may be read, and looks in the usual places for textures.
        content_ = image_path(uri, folder);
        look.path = content_.c_str();
        return;
    }
    if (bytes.empty()) image.refuse("an empty image", "an encoded one");
    look.bytes = reinterpret_cast<const uint8_t*>(bytes.data());
    look.byte_count = bytes.size();
}

}  // namespace gltf_import
