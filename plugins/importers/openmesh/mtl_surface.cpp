#include "mtl_surface.hpp"

#include <algorithm>
#include <cmath>

namespace openmesh_import {
namespace {

float largest(const float c[3]) {
    return std::max({c[0], c[1], c[2]});
}

bool is_there(const ObjTexture& texture) {
    return !texture.names.empty();
}

bool is_pbr(const MtlStatements& s) {
    return std::any_of(s.pbr.begin(), s.pbr.end(), [](const auto& number) { return number.has_value(); }) ||
           std::any_of(s.pbr_maps.begin(), s.pbr_maps.end(), is_there);
}

void read_maps(const MtlStatements& s, bool pbr, ObjMaterial& m) {
    const auto use = [&](rt_u32 use, rt_u32 space, const ObjTexture& texture) {
        if (is_there(texture)) m.maps.push_back({use, space, texture});
    };
    const bool alpha_of_color = s.dissolve_map.names == s.texture.names;
    use(RT_MAP_COLOR, RT_SPACE_SRGB, s.texture);
    use(RT_MAP_EMISSION, RT_SPACE_SRGB, s.emission_map);
    if (is_there(s.normal_map))
        use(RT_MAP_NORMAL, RT_SPACE_LINEAR, s.normal_map);
    else
        use(RT_MAP_NORMAL, RT_SPACE_HEIGHT, s.bump_map);
    if (!alpha_of_color) use(RT_MAP_OPACITY, RT_SPACE_LINEAR, s.dissolve_map);
    if (pbr) use(RT_MAP_TRANSMISSION, RT_SPACE_LINEAR, s.filter_map);
    for (size_t i = 0; i < kPbrCount; ++i) use(kPbr[i].use, RT_SPACE_LINEAR, s.pbr_maps[i]);
}

// `d` is the share of the surface that is there. A map_d that names the picture of map_Kd means its alpha; of another picture
// the red channel counts.
void read_alpha(const MtlStatements& s, ObjMaterial& m) {
    importers::AlphaKeys alpha;
    if (s.dissolve < 1 || is_there(s.dissolve_map)) alpha.set(importers::AlphaKeys::blend, s.dissolve);
    alpha.give(m.keys);
}

// A surface of glTF. Missing numbers are those of Blender's new materials. A map replaces its number, because programs leave
// any number beside it.
void read_pbr(const MtlStatements& s, ObjMaterial& m) {
    m.keys.set("model", importers::gltf_model);
    m.keys.set("metallic", 0);
    m.keys.set("sheen_roughness", 0.5);
    m.keys.set("clearcoat_roughness", 0.03);
    m.keys.set("roughness", importers::roughness_of(s.exponent));
    if (s.ior > 1) m.keys.set("ior", std::min(s.ior, 10.0f));
    for (size_t i = 0; i < kPbrCount; ++i) {
        if (is_there(s.pbr_maps[i]))
            m.keys.set(kPbr[i].key, 1);
        else if (s.pbr[i])
            m.keys.set(kPbr[i].key, *s.pbr[i] * kPbr[i].factor);
    }
    // Blender writes the weight of its transmission as the filter.
    if (is_there(s.filter_map))
        m.keys.set("transmission", 1);
    else if (s.has_filter)
        m.keys.set("transmission", (s.filter[0] + s.filter[1] + s.filter[2]) / 3);
    if (is_there(s.filter_map) || (s.has_filter && largest(s.filter) > 0)) m.keys.set("thin", 0);
    read_alpha(s, m);
}

bool is_glass(const MtlStatements& s) {
    return s.illumination == 4 || s.illumination == 6 || s.illumination == 7 || s.illumination == 9;
}

bool is_clear(const MtlStatements& s) {
    return s.dissolve >= 1;
}

// What a surface of glTF has no place for, though the file states it. Blender writes a Ks of 0.5 for its plain surface.
void name_ignored_by_pbr(const MtlStatements& s, std::vector<std::string>& left_out) {
    if (s.has_specular && std::any_of(s.specular, s.specular + 3, [](float strength) { return strength != 0.5f; }))
        left_out.emplace_back("Ks");
    if (is_glass(s) && !s.has_filter && !is_there(s.filter_map) && is_clear(s)) left_out.emplace_back("illum");
}

// Wavefront's illumination models: 0 shows the colour as it is; 3, 5 and 8 (without ray tracing) mirror; 4, 6, 7 and 9 are
// glass. Source: "MTL material format", appendix B1 of Wavefront's manual, 1995.
void read_illumination(const MtlStatements& s, ObjMaterial& m) {
    rt_material_desc& out = m.values;
    const bool mirrors = s.illumination == 3 || s.illumination == 5 || s.illumination == 8;
    if (s.illumination == 0) m.keys.set("model", importers::unlit_model);
    const bool is_dull = s.illumination == 0 || s.illumination == 1, is_unstated = largest(s.specular) == 0;
    for (int k = 0; k < 3; ++k)
        out.specular[k] = is_dull ? 0 : is_there(s.specular_map) && is_unstated ? 1 : std::min(s.specular[k], 1.0f);
    out.shininess = std::clamp(s.exponent, 1.0f, 10000.0f);
    out.ior = 1;
    if (is_glass(s)) {
        out.refract = std::clamp(1 - s.dissolve, 0.0f, 1.0f);
        out.ior = s.ior > 1 ? std::min(s.ior, 10.0f) : 1.5f;
        if (is_clear(s)) {
            // Glass without an opacity is clear. Its hue is that of the transmission filter; the filter's strength is ignored,
            // because programs write it in either sense. The diffuse colour keeps its share of the light.
            out.refract = 1 - largest(out.color);
            const float strongest = std::max(largest(s.filter), 1e-6f);
            for (int k = 0; k < 3; ++k) out.color[k] = s.filter[k] / strongest;
        }
    } else {
        read_alpha(s, m);
    }
    if (mirrors) out.reflect = std::min(largest(s.specular), 1 - out.refract);
    if (importers::add_highlight(out, m.keys) && is_there(s.specular_map))
        m.maps.push_back({RT_MAP_SPECULAR_COLOR, RT_SPACE_SRGB, s.specular_map});
}

}  // namespace

ObjMaterial to_material(const MtlStatements& s) {
    ObjMaterial m;
    const bool pbr = is_pbr(s);
    read_maps(s, pbr, m);
    rt_material_desc& out = m.values;
    out.texture = RT_NONE;
    for (int k = 0; k < 3; ++k) {
        out.color[k] = std::min(s.diffuse[k], 1.0f);
        out.emission[k] = s.emission[k];
    }
    if (is_there(s.texture) && (!s.has_diffuse || largest(out.color) == 0)) std::fill(out.color, out.color + 3, 1.0f);
    // Programs leave Ke black beside its picture.
    if (is_there(s.emission_map) && largest(out.emission) == 0) std::fill(out.emission, out.emission + 3, 1.0f);
    if (pbr)
        read_pbr(s, m);
    else
        read_illumination(s, m);
    // Only clear glass has the hue of its filter. Programs write a grey filter, as they write `Ni`, for what is opaque.
    const bool has_hue = s.filter[0] != s.filter[1] || s.filter[1] != s.filter[2];
    if (has_hue && !is_there(s.filter_map) && (pbr || !is_glass(s) || !is_clear(s))) m.left_out.emplace_back("hue of Tf");
    if (is_there(s.filter_map) && !pbr) m.left_out.emplace_back("map_Tf");
    if (pbr) name_ignored_by_pbr(s, m.left_out);
    // What glass lets through is one number.
    if (!pbr && is_glass(s) && is_there(s.dissolve_map)) {
        importers::drop_map(m.maps, RT_MAP_OPACITY);
        m.left_out.emplace_back("map_d");
    }
    return m;
}

}  // namespace openmesh_import
