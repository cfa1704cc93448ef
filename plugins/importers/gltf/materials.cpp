#include "materials.hpp"

#include <algorithm>
#include <cmath>

#include "../common/materials.hpp"
#include "nodes.hpp"
#include "rt_plugin.hpp"
#include "tolerant.hpp"
#include "uri.hpp"

namespace gltf_import {
namespace {

// The texture of the colour, as the material describes it.
Value color_texture(const Value& material) {
    const Value gloss = material.object("extensions").object("KHR_materials_pbrSpecularGlossiness");
    if (gloss.has("diffuseTexture")) return gloss["diffuseTexture"];
    return material.object("pbrMetallicRoughness").object("baseColorTexture");
}

// The properties that are keys of the host as they are, by extension ("": of the material's pbrMetallicRoughness). Sources:
// glTF 2.0, section 3.9, and the README of each extension in Khronos' registry.
struct Property {
    const char *extension, *name, *key;
    unsigned count;
    double factor;
};
constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr Property kProperties[] = {
    {"", "metallicFactor", "metallic", 1, 1},
    {"", "roughnessFactor", "roughness", 1, 1},
    {"KHR_materials_specular", "specularFactor", "specular_weight", 1, 1},
    {"KHR_materials_specular", "specularColorFactor", "specular_color", 3, 1},
    {"KHR_materials_clearcoat", "clearcoatFactor", "clearcoat", 1, 1},
    {"KHR_materials_clearcoat", "clearcoatRoughnessFactor", "clearcoat_roughness", 1, 1},
    {"KHR_materials_sheen", "sheenColorFactor", "sheen_color", 3, 1},
    {"KHR_materials_sheen", "sheenRoughnessFactor", "sheen_roughness", 1, 1},
    {"KHR_materials_transmission", "transmissionFactor", "transmission", 1, 1},
    {"KHR_materials_anisotropy", "anisotropyStrength", "anisotropy", 1, 1},
    {"KHR_materials_anisotropy", "anisotropyRotation", "anisotropy_rotation", 1, kDegrees},
    {"KHR_materials_iridescence", "iridescenceFactor", "iridescence", 1, 1},
    {"KHR_materials_iridescence", "iridescenceIor", "iridescence_ior", 1, 1},
    {"KHR_materials_iridescence", "iridescenceThicknessMaximum", "iridescence_thickness", 1, 1},
    {"KHR_materials_iridescence", "iridescenceThicknessMinimum", "iridescence_thickness_min", 1, 1},
};

void read_property(const Value& of, const Property& p, importers::MaterialKeys& keys) {
    if (!of.has(p.name)) return;
    if (p.count == 3)
        keys.set(p.key, of.numbers<3>(p.name, {}));
    else
        keys.set(p.key, p.factor * of.number(p.name, 0));
}

// KHR_materials_ior: 0 stands for an infinite one, which reflects all light, as one near 0 does.
void read_ior(const Value& extension, importers::MaterialKeys& keys) {
    if (extension.has("ior")) keys.set("ior", std::max(extension.number("ior", 1.5), 1e-3));
}

// KHR_materials_volume: a thickness above 0 says that the surface bounds a solid, whose colour is what is left of white light
// after the distance.
void read_volume(const Value& extension, importers::MaterialKeys& keys) {
    if (!(extension.number("thicknessFactor", 0) > 0)) return;
    keys.set("thin", 0);
    if (!extension.has("attenuationDistance")) return;
    const double distance = extension.number("attenuationDistance", 0);
    std::array<double, 3> absorption = extension.numbers<3>("attenuationColor", {1, 1, 1});
    for (double& channel : absorption) channel = distance > 0 ? -std::log(std::clamp(channel, 1e-6, 1.0)) / distance : 0;
    keys.set("absorption", absorption);
}

// Specification, section 3.9.4.
void read_alpha(const Value& material, double opacity, importers::AlphaKeys& alpha) {
    const std::string mode = material.text("alphaMode", "OPAQUE");
    if (mode == "MASK")
        alpha.set(importers::AlphaKeys::mask, opacity, material.number("alphaCutoff", 0.5));
    else if (mode == "BLEND")
        alpha.set(importers::AlphaKeys::blend, opacity);
    else if (mode != "OPAQUE")
        material["alphaMode"].refuse("'OPAQUE', 'MASK' or 'BLEND'");
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

Materials::Materials(const Document& document, Accessors& accessors, const rt_scene_sink& sink)
    : accessors_(accessors),
      folder_(document.folder()),
      materials_(spared_list(document, "materials", sink)),
      textures_(spared_list(document, "textures", sink)),
      images_(spared_list(document, "images", sink)),
      samplers_(spared_list(document, "samplers", sink)),
      sink_(sink),
      ids_(materials_.size()) {}

rt_u32 Materials::id(const Value& primitive) {
    rt_u32 id = RT_NONE;
    spared(sink_, "it gets the default material", [&] {
        const auto index = primitive.index("material", materials_);
        if (!index) return;
        if (!ids_[*index]) ids_[*index] = add(materials_[*index]);
        id = *ids_[*index];
    });
    return id;
}

// Each group of values that the file has wrong keeps its defaults.
rt_u32 Materials::add(const Value& material) {
    const std::string name = material.name();
    rt_material_desc out = rt::material(name.c_str());
    std::array<double, 4> base = {1, 1, 1, 1};
    importers::AlphaKeys alpha;
    importers::MaterialKeys keys;
    const Value extensions = material.object("extensions");
    const bool is_gloss = extensions.has("KHR_materials_pbrSpecularGlossiness");
    const auto group = [&](const auto& read) { spared(sink_, "the material keeps the default there", read); };
    importers::store_color(base, 1, 1, out.color);
    group([&] {
        const Value gloss = extensions.object("KHR_materials_pbrSpecularGlossiness");
        const std::array<double, 4> factor = gloss.numbers<4>(
            "diffuseFactor", material.object("pbrMetallicRoughness").numbers<4>("baseColorFactor", {1, 1, 1, 1}));
        base = factor;
        importers::store_color(base, 1, 1, out.color);
    });
    group([&] { out.texture = texture(color_texture(material)); });
    keys.set("model", extensions.has("KHR_materials_unlit") ? importers::unlit_model : importers::gltf_model);
    keys.set("metallic", is_gloss ? 0 : 1);  // specified defaults, which are not those of the host
    keys.set("roughness", 1);
    for (const Property& p : kProperties)
        group([&] {
            const bool is_core = *p.extension == 0;
            if (is_core && is_gloss) return;
            read_property(is_core ? material.object("pbrMetallicRoughness") : extensions.object(p.extension), p, keys);
        });
    group([&] { read_ior(extensions.object("KHR_materials_ior"), keys); });
    group([&] { read_volume(extensions.object("KHR_materials_volume"), keys); });
    group([&] {
        // The host has one texture, which multiplies the colour. A picture that confines emission to a part of the surface is
        // lost.
        const std::array<double, 3> emission = material.numbers<3>("emissiveFactor", {0, 0, 0});
        const double strength = extensions.object("KHR_materials_emissive_strength").number("emissiveStrength", 1);
        const bool shines = emission[0] > 0 || emission[1] > 0 || emission[2] > 0;
        if (shines && material.has("emissiveTexture"))
            rt::warn(sink_, material.path() + " shines as a picture says (emissiveTexture); that light is left out");
        else
            importers::store_color(emission, strength, 1000, out.emission);
    });
    group([&] { read_alpha(material, base[3], alpha); });
    alpha.give(keys);
    keys.give(out);
    return rt::id(sink_.material(sink_.ctx, &out));
}

TextureMapping Materials::mapping(const Value& primitive) const {
    TextureMapping mapping;
    if (!primitive.has("material") || primitive["material"].json().is_null()) return mapping;
    const auto read = [&] {
        const Value info = color_texture(materials_[*primitive.index("material", materials_)]);
        const Value transform = info.object("extensions").object("KHR_texture_transform");
        const std::array<double, 2> offset = transform.numbers<2>("offset", {0, 0}),
                                    scale = transform.numbers<2>("scale", {1, 1});
        mapping.set = transform.count("texCoord", info.count("texCoord", 0));
        // Counter-clockwise where v points down.
        const double angle = transform.number("rotation", 0), c = std::cos(angle), s = std::sin(angle);
        mapping.matrix = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
    };
    try {
        read();
    } catch (const Error&) {
        return {};  // add() names what is wrong
    }
    return mapping;
}

rt_u32 Materials::texture(const Value& info) {
    if (!info.has("index")) return RT_NONE;
    const Value texture = textures_[info["index"].index(textures_)];
    const auto image = texture.index("source", images_);
    if (!image) {
        // Only an extension names an image, of a kind that the host does not read (WebP, KTX).
        const std::string text = texture.path() + " has no 'source', so the material stays without it";
        return rt::warn(sink_, text), RT_NONE;
    }
    rt_u32 wrap_u = RT_WRAP_REPEAT, wrap_v = RT_WRAP_REPEAT;
    spared(sink_, "the texture repeats", [&] {
        const auto sampler = texture.index("sampler", samplers_);
        if (!sampler) return;
        wrap_u = wrap_mode(samplers_[*sampler], "wrapS");
        wrap_v = wrap_mode(samplers_[*sampler], "wrapT");
    });
    const auto known = texture_ids_.insert({{*image, wrap_u, wrap_v}, RT_NONE});
    rt_u32& id = known.first->second;
    if (known.second) spared(sink_, "the image is left out", [&] { id = add_image(images_[*image], wrap_u, wrap_v); });
    return id;
}

rt_u32 Materials::wrap_mode(const Value& sampler, const char* key) const {
    constexpr std::pair<uint64_t, rt_u32> kModes[] = {{10497, RT_WRAP_REPEAT}, {33071, RT_WRAP_CLAMP}, {33648, RT_WRAP_MIRROR}};
    const uint64_t code = sampler.count(key, 10497);
    for (const auto& [known, mode] : kModes)
        if (known == code) return mode;
    sampler[key].refuse("10497 (repeat), 33071 (clamp to edge) or 33648 (mirrored repeat)");
}

rt_u32 Materials::add_image(const Value& image, rt_u32 wrap_u, rt_u32 wrap_v) {
    rt_texture_desc out{};
    out.struct_bytes = sizeof out;
    out.wrap_u = wrap_u;
    out.wrap_v = wrap_v;
    std::string bytes_or_path;
    std::string_view bytes;
    if (image.has("bufferView")) {
        bytes = accessors_.view(image["bufferView"]);
    } else if (const Value uri = image["uri"]; decode_data_uri(uri, bytes_or_path)) {
        bytes = bytes_or_path;
    } else {
        // The host decides what may be read, and looks in the usual places for textures.
        bytes_or_path = image_path(uri, folder_);
        out.path = bytes_or_path.c_str();
        return sink_.texture(sink_.ctx, &out);
    }
    if (bytes.empty()) image.refuse("an empty image", "an encoded one");
    out.bytes = reinterpret_cast<const uint8_t*>(bytes.data());
    out.byte_count = bytes.size();
    return sink_.texture(sink_.ctx, &out);
}

}  // namespace gltf_import
