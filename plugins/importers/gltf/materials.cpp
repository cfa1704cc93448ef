#include "materials.hpp"

#include <algorithm>
#include <cmath>

#include "../common/materials.hpp"
#include "../common/numbers.hpp"
#include "nodes.hpp"
#include "rt_plugin.hpp"
#include "tolerant.hpp"

namespace gltf_import {
namespace {

// The properties that are keys of the host as they are, by extension ("": of the material's pbrMetallicRoughness). Sources:
// glTF 2.0, section 3.9, and the README of each extension in Khronos' registry.
struct Property {
    const char *extension, *name, *key;
    unsigned count;
    double factor;
};
constexpr double kDegrees = 180 / importers::kPi;
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

// The extensions of a material that are left out.
std::vector<std::string> unknown_extensions(const Value& material) {
    constexpr const char* kOthers[] = {"KHR_materials_ior", "KHR_materials_volume", "KHR_materials_emissive_strength",
                                       "KHR_materials_unlit", "KHR_materials_pbrSpecularGlossiness"};
    std::vector<std::string> unknown;
    if (!material.has("extensions")) return unknown;
    const Value extensions = material["extensions"];
    if (!extensions.json().is_object()) return unknown;
    for (const auto& extension : extensions.json().items()) {
        const std::string& name = extension.key();
        const auto is_name = [&](const char* known) { return name == known; };
        const bool known =
            std::any_of(std::begin(kOthers), std::end(kOthers), is_name) ||
            std::any_of(std::begin(kProperties), std::end(kProperties), [&](const Property& p) { return name == p.extension; });
        if (!known) unknown.push_back(name);
    }
    return unknown;
}

// KHR_materials_pbrSpecularGlossiness (archived): a surface that is no metal, with the reflectance straight on that it states,
// which is that of an ior of 1.5 times a color, and a roughness of 1 - glossiness.
void read_gloss(const Value& extension, importers::MaterialKeys& keys) {
    constexpr double kOfIor = 0.04;
    std::array<double, 3> color = extension.numbers<3>("specularFactor", {1, 1, 1});
    for (double& channel : color) channel /= kOfIor;
    keys.set("metallic", 0);
    keys.set("specular_color", color);
    keys.set("roughness", 1 - extension.number("glossinessFactor", 1));
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

}  // namespace

Materials::Materials(const Document& document, Accessors& accessors, const rt_scene_sink& sink)
    : materials_(spared_list(document, "materials", sink)),
      maps_(document, accessors, sink),
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
    std::vector<std::string> left_out = unknown_extensions(material);
    keys.set("model", extensions.has("KHR_materials_unlit") ? importers::unlit_model : importers::gltf_model);
    keys.set("metallic", 1);  // specified defaults, which are not those of the host
    keys.set("roughness", 1);
    for (const Property& p : kProperties)
        group([&] {
            const bool is_core = *p.extension == 0;
            if (is_core && is_gloss) return;
            read_property(is_core ? material.object("pbrMetallicRoughness") : extensions.object(p.extension), p, keys);
        });
    if (is_gloss) group([&] { read_gloss(extensions.object("KHR_materials_pbrSpecularGlossiness"), keys); });
    group([&] { read_ior(extensions.object("KHR_materials_ior"), keys); });
    group([&] { read_volume(extensions.object("KHR_materials_volume"), keys); });
    group([&] {
        const std::array<double, 3> emission = material.numbers<3>("emissiveFactor", {0, 0, 0});
        const double strength = extensions.object("KHR_materials_emissive_strength").number("emissiveStrength", 1);
        importers::store_color(emission, strength, 1000, out.emission);
    });
    std::vector<rt_map_desc> maps;
    group([&] {
        const bool emits = out.emission[0] > 0 || out.emission[1] > 0 || out.emission[2] > 0;
        maps = maps_.read(material, emits, left_out);
        importers::give_maps(maps, out);
    });
    group([&] { read_alpha(material, base[3], alpha); });
    alpha.give(keys);
    keys.give(out);
    if (!left_out.empty()) {
        std::string list;
        for (const std::string& what : left_out) list += (list.empty() ? "" : ", ") + what;
        rt::warn(sink_, (name.empty() ? material.path() : "material '" + name + "'") + ": left out " + list);
    }
    return rt::id(sink_.material(sink_.ctx, &out));
}

TextureSets Materials::sets(const Value& primitive) const {
    if (!primitive.has("material") || primitive["material"].json().is_null()) return {0};
    try {
        return maps_.sets(materials_[*primitive.index("material", materials_)]);
    } catch (const Error&) {
        return {0};  // id() names what is wrong
    }
}

}  // namespace gltf_import
