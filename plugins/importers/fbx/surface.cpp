#include "surface.hpp"

#include <algorithm>
#include <cmath>

namespace fbx_import {
namespace {

// Numbers that are keys of the host. A row counts only if `enabled_by` is missing in the file or is not 0. Sources: Autodesk
// Standard Surface 1.0.1 (Maya|..., also of Arnold); 3ds Max' help, "Physical Material" and "glTF Material"
// (3dsMax|Parameters|..., 3dsMax|main|..., 3dsMax|extension|...); Maya's help, "Stingray PBS".
struct Number {
    const char *name, *key;
    unsigned count;
    double factor;
    rt_u32 use;  // whose picture replaces the value; RT_NONE: there is no such
    const char* enabled_by;
};
constexpr Number kNumbers[] = {
    {"metalness", "metallic", 1, 1, RT_MAP_METALLIC, ""},
    {"metallic", "metallic", 1, 1, RT_MAP_METALLIC, ""},
    {"roughness", "roughness", 1, 1, RT_MAP_ROUGHNESS, ""},
    {"specularroughness", "roughness", 1, 1, RT_MAP_ROUGHNESS, ""},
    {"specular", "specular_weight", 1, 1, RT_NONE, "enablespecular"},
    {"reflectivity", "specular_weight", 1, 1, RT_NONE, ""},
    {"specularcolor", "specular_color", 3, 1, RT_MAP_SPECULAR_COLOR, "enablespecular"},
    {"reflcolor", "specular_color", 3, 1, RT_MAP_SPECULAR_COLOR, ""},
    {"specularior", "ior", 1, 1, RT_NONE, ""},
    {"transior", "ior", 1, 1, RT_NONE, ""},
    {"indexofrefraction", "ior", 1, 1, RT_NONE, "enableindexofrefraction"},
    {"specularanisotropy", "anisotropy", 1, 1, RT_NONE, ""},
    {"specularrotation", "anisotropy_rotation", 1, 360, RT_NONE, ""},
    {"coat", "clearcoat", 1, 1, RT_MAP_CLEARCOAT, ""},
    {"coating", "clearcoat", 1, 1, RT_MAP_CLEARCOAT, ""},
    {"clearcoat", "clearcoat", 1, 1, RT_MAP_CLEARCOAT, "enableclearcoat"},
    {"coatroughness", "clearcoat_roughness", 1, 1, RT_MAP_CLEARCOAT_ROUGHNESS, ""},
    {"clearcoatroughness", "clearcoat_roughness", 1, 1, RT_MAP_CLEARCOAT_ROUGHNESS, "enableclearcoat"},
    {"sheenroughness", "sheen_roughness", 1, 1, RT_NONE, "enablesheen"},
    {"transmission", "transmission", 1, 1, RT_MAP_TRANSMISSION, "enabletransmission"},
    {"transparency", "transmission", 1, 1, RT_MAP_TRANSMISSION, ""},
    {"thinfilmior", "iridescence_ior", 1, 1, RT_NONE, ""},
    {"thinfilmthickness", "iridescence_thickness", 1, 1, RT_NONE, ""},  // nanometres
};

constexpr SurfaceMap kMaps[] = {
    {"metalness", RT_MAP_METALLIC, RT_SPACE_LINEAR},
    {"metallic", RT_MAP_METALLIC, RT_SPACE_LINEAR},
    {"roughness", RT_MAP_ROUGHNESS, RT_SPACE_LINEAR},
    {"specularroughness", RT_MAP_ROUGHNESS, RT_SPACE_LINEAR},
    {"specularcolor", RT_MAP_SPECULAR_COLOR, RT_SPACE_SRGB},
    {"reflcolor", RT_MAP_SPECULAR_COLOR, RT_SPACE_SRGB},
    {"coat", RT_MAP_CLEARCOAT, RT_SPACE_LINEAR},
    {"coating", RT_MAP_CLEARCOAT, RT_SPACE_LINEAR},
    {"clearcoat", RT_MAP_CLEARCOAT, RT_SPACE_LINEAR},
    {"coatroughness", RT_MAP_CLEARCOAT_ROUGHNESS, RT_SPACE_LINEAR},
    {"coatrough", RT_MAP_CLEARCOAT_ROUGHNESS, RT_SPACE_LINEAR},
    {"clearcoatroughness", RT_MAP_CLEARCOAT_ROUGHNESS, RT_SPACE_LINEAR},
    {"coatnormal", RT_MAP_CLEARCOAT_NORMAL, RT_SPACE_LINEAR},
    {"clearcoatnormal", RT_MAP_CLEARCOAT_NORMAL, RT_SPACE_LINEAR},
    {"sheencolor", RT_MAP_SHEEN_COLOR, RT_SPACE_SRGB},
    {"transmission", RT_MAP_TRANSMISSION, RT_SPACE_LINEAR},
    {"transparency", RT_MAP_TRANSMISSION, RT_SPACE_LINEAR},
    {"emissioncolor", RT_MAP_EMISSION, RT_SPACE_SRGB},
    {"emission", RT_MAP_EMISSION, RT_SPACE_SRGB},
    {"emitcolor", RT_MAP_EMISSION, RT_SPACE_SRGB},
    {"emissive", RT_MAP_EMISSION, RT_SPACE_SRGB},
    {"opacity", RT_MAP_OPACITY, RT_SPACE_LINEAR},
    {"cutout", RT_MAP_OPACITY, RT_SPACE_LINEAR},
    {"alpha", RT_MAP_OPACITY, RT_SPACE_LINEAR},
    {"ambientocclusion", RT_MAP_OCCLUSION, RT_SPACE_LINEAR},
    {"ao", RT_MAP_OCCLUSION, RT_SPACE_LINEAR},
    // Bumps may be maps of normals; the host tells them from heights.
    {"normal", RT_MAP_NORMAL, RT_SPACE_LINEAR},
    {"normalcamera", RT_MAP_NORMAL, RT_SPACE_HEIGHT},
    {"bump", RT_MAP_NORMAL, RT_SPACE_HEIGHT},
};

// What the host has no key for: it is named if the file states another value than the neutral one and `of`, whose part it is,
// is above 0. Source: Autodesk Standard Surface 1.0.1.
struct LeftOut {
    const char* name;
    double neutral;
    const char* of;  // or "": it counts by itself
};
constexpr LeftOut kLeftOut[] = {
    {"subsurface", 0, ""},
    {"scattering", 0, ""},
    {"transmissiondispersion", 0, ""},
    {"dispersion", 0, ""},
    {"transmissionscatter", 0, "transmission"},
    {"transmissionextraroughness", 0, ""},
    {"coatcolor", 1, "coat"},
    {"coatcolor", 1, "coating"},
    {"coatior", 1.5, "coat"},
    {"coatanisotropy", 0, ""},
    {"coataffectcolor", 0, ""},
    {"coataffectroughness", 0, ""},
    {"diffuseroughness", 0, ""},
    {"diffroughness", 0, ""},
};
constexpr double kNearlyNeutral = 1e-4;

double largest(const Vec3& v) {
    return std::max({v[0], v[1], v[2]});
}

constexpr std::string_view kMap = "map";
bool ends_with_map(const std::string& name) {
    return name.size() > kMap.size() && name.compare(name.size() - kMap.size(), kMap.size(), kMap) == 0;
}
// The name without prefixes in lower case; empty of properties without a prefix, which are the SDK's own, as DiffuseColor.
std::string words_of(std::string_view property) {
    constexpr std::string_view kFile = "|file";
    if (property.size() > kFile.size() && property.substr(property.size() - kFile.size()) == kFile)
        property.remove_suffix(kFile.size());
    const size_t bar = property.rfind('|');
    if (bar == property.npos) return "";
    property.remove_prefix(bar + 1);
    std::string out;
    for (const char c : property)
        if (c != '_') out += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return out;
}

}  // namespace

std::string plain_name(std::string_view property) {
    std::string out = words_of(property);
    if (out.rfind("tex", 0) == 0) out.erase(0, 3);
    if (ends_with_map(out)) out.resize(out.size() - kMap.size());
    return out;
}

const SurfaceMap* surface_map(std::string_view plain) {
    for (const SurfaceMap& map : kMaps)
        if (plain == map.name) return &map;
    return nullptr;
}

// A number stands for all three channels.
Surface::Surface(const Properties& properties) {
    properties.each([&](std::string_view name) {
        const std::string plain = words_of(name);
        const double first = properties.number(name, 0);
        if (!plain.empty() && !ends_with_map(plain)) values_.emplace(plain, properties.vector(name, {first, first, first}));
    });
}

const Vec3* Surface::number_of(std::string_view name) const {
    const auto found = values_.find(std::string(name));
    return found == values_.end() ? nullptr : &found->second;
}

double Surface::number(std::string_view name, double otherwise) const {
    const Vec3* const found = number_of(name);
    return found ? (*found)[0] : otherwise;
}

Vec3 Surface::color(std::string_view name, const Vec3& otherwise) const {
    const Vec3* const found = number_of(name);
    return found ? *found : otherwise;
}

// The color of glTF's transmission is that of the surface; where a depth is stated, it is what is left after that depth.
void Surface::read_color(bool has_color_map, MaterialKeys& keys, rt_material_desc& out) const {
    const double weight = has_color_map ? 1 : number("base", number("baseweight", 1));
    Vec3 base = has_color_map ? Vec3{1, 1, 1} : color("basecolor", {0.8, 0.8, 0.8});
    for (double& channel : base) channel *= weight;
    const bool enabled = number("enabletransmission", 1) != 0;
    const double clear = enabled ? std::clamp(number("transmission", number("transparency", 0)), 0.0, 1.0) : 0;
    if (clear > 0) {
        const Vec3 through = color("transmissioncolor", color("transcolor", {1, 1, 1}));
        const double depth = number("transmissiondepth", number("transdepth", 0));
        keys.set("thin", number("thinwalled", 0) != 0);
        if (number_of("transmissioncolor") || number_of("transcolor"))
            for (size_t k = 0; k < 3; ++k) base[k] += clear * ((depth > 0 ? 1 : through[k]) - base[k]);
        std::array<double, 3> absorption{};
        for (size_t k = 0; k < 3 && depth > 0; ++k) absorption[k] = -std::log(std::clamp(through[k], 1e-6, 1.0)) / depth;
        keys.set("absorption", absorption);
    }
    store_color(base, 1, 1, out.color);
}

// 3ds Max' Physical Material has a color that is black unless it glows, Standard Surface a weight of 0.
void Surface::read_emission(const std::vector<rt_map_desc>& maps, rt_material_desc& out) const {
    const Vec3 stated = color("emissioncolor", color("emitcolor", color("emissive", {})));
    const double weight = number("emission", 1) * number("emissiveintensity", 1);
    store_color(has_map(maps, RT_MAP_EMISSION) ? Vec3{1, 1, 1} : stated, weight, 1000, out.emission);
}

void Surface::read(const std::vector<rt_map_desc>& maps, bool has_color_map, MaterialKeys& keys, AlphaKeys& alpha,
                   rt_material_desc& out, std::vector<std::string>& left_out) const {
    keys.set("model", number("unlit", 0) != 0 ? unlit_model : gltf_model);
    keys.set("metallic", 0);
    keys.set("roughness", 0.2);  // of Standard Surface
    read_color(has_color_map, keys, out);
    read_emission(maps, out);
    for (const Number& row : kNumbers) {
        const Vec3* const value = number_of(row.name);
        if (row.use != RT_NONE && has_map(maps, row.use))
            keys.set(row.key, 1);
        else if (value && number(row.enabled_by, 1) != 0)
            keys.set(row.key, {(*value)[0] * row.factor, (*value)[1] * row.factor, (*value)[2] * row.factor});
    }
    // 3ds Max may state how smooth a surface is.
    if (number("roughnessinv", 0) != 0 && !has_map(maps, RT_MAP_ROUGHNESS)) keys.set("roughness", 1 - number("roughness", 0));
    const Vec3 sheen = color("sheencolor", {1, 1, 1});
    const double fibres = number("enablesheen", 1) != 0 ? number("sheen", number_of("enablesheen") ? 1 : 0) : 0;
    keys.set("sheen_color", has_map(maps, RT_MAP_SHEEN_COLOR)
                                ? std::array<double, 3>{1, 1, 1}
                                : std::array<double, 3>{fibres * sheen[0], fibres * sheen[1], fibres * sheen[2]});
    if (number("thinfilmthickness", 0) > 0) keys.set("iridescence", 1);
    const Vec3 opacity = color("opacity", {1, 1, 1});
    const bool is_cut = has_map(maps, RT_MAP_OPACITY);
    if (is_cut || largest(opacity) < 1) alpha.set(AlphaKeys::blend, is_cut ? 1 : (opacity[0] + opacity[1] + opacity[2]) / 3);
    if (!is_cut && has_hue(opacity)) left_out.emplace_back("hue of opacity");
    for (const LeftOut& row : kLeftOut) {
        const Vec3* const value = number_of(row.name);
        const auto differs = [&](double channel) { return std::abs(channel - row.neutral) > kNearlyNeutral; };
        const bool counts = row.of[0] == 0 || number(row.of, 0) > 0;
        if (value && counts && std::any_of(value->begin(), value->end(), differs)) left_out.emplace_back(row.name);
    }
}

}  // namespace fbx_import
