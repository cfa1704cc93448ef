#include "materials.hpp"

#include <algorithm>

#include "../common/materials.hpp"
#include "nodes.hpp"
#include "rt_plugin.hpp"
#include "tolerant.hpp"

namespace gltf_import {
namespace {

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
    const auto group = [&](const auto& read) { spared(sink_, "the material keeps the default there", read); };
    importers::store_color(base, 1, 1, out.color);
    group([&] {
        const Value gloss = material.object("extensions").object("KHR_materials_pbrSpecularGlossiness");
        const std::array<double, 4> factor = gloss.numbers<4>(
            "diffuseFactor", material.object("pbrMetallicRoughness").numbers<4>("baseColorFactor", {1, 1, 1, 1}));
        base = factor;
        importers::store_color(base, 1, 1, out.color);
    });
    group([&] {
        const Value pbr = material.object("pbrMetallicRoughness");
        importers::apply_metallic(pbr.number("metallicFactor", 1), pbr.number("roughnessFactor", 1), out);
    });
    group([&] {
        const std::array<double, 3> emission = material.numbers<3>("emissiveFactor", {0, 0, 0});
        const double strength =
            material.object("extensions").object("KHR_materials_emissive_strength").number("emissiveStrength", 1);
        importers::store_color(emission, strength, 1000, out.emission);
    });
    std::vector<rt_map_desc> maps;
    group([&] {
        const bool emits = out.emission[0] > 0 || out.emission[1] > 0 || out.emission[2] > 0;
        maps = maps_.read(material, emits);
        out.maps = maps.data();
        out.map_count = static_cast<rt_u32>(maps.size());
        out.map_bytes = sizeof(rt_map_desc);
    });
    group([&] {
        const Value extensions = material.object("extensions");
        const double transmission = extensions.object("KHR_materials_transmission").number("transmissionFactor", 0);
        importers::apply_transparency(1, transmission, extensions.object("KHR_materials_ior").number("ior", 0), alpha, out);
    });
    group([&] { read_alpha(material, base[3], alpha); });
    alpha.give(out);
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
