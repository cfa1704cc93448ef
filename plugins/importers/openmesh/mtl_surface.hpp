// mtl_surface.hpp -- what the statements of a material in a Wavefront material file mean.
#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "mtl.hpp"

namespace openmesh_import {

// Statements of the extension for physically based rendering. If a material has a number of them, it is a surface of glTF.
struct PbrNumber {
    std::string_view word, map_word;  // lower case; the statement of its map, or ""
    const char* key;                  // of the host's materials
    double factor;
    rt_u32 use;  // of its map
};
// Sources: "Extending Wavefront MTL for Physically-Based", Exocortex, 2015 (names); Blender's importer (`anisor` is in turns).
inline constexpr PbrNumber kPbr[] = {
    {"pr", "map_pr", "roughness", 1, RT_MAP_ROUGHNESS},
    {"pm", "map_pm", "metallic", 1, RT_MAP_METALLIC},
    {"ps", "map_ps", "sheen_color", 1, RT_MAP_SHEEN_COLOR},
    {"pc", "map_pc", "clearcoat", 1, RT_MAP_CLEARCOAT},
    {"pcr", "map_pcr", "clearcoat_roughness", 1, RT_MAP_CLEARCOAT_ROUGHNESS},
    {"aniso", "", "anisotropy", 1, RT_NONE},
    {"anisor", "", "anisotropy_rotation", 360, RT_NONE},
};
inline constexpr size_t kPbrCount = sizeof kPbr / sizeof *kPbr;

// The statements of one material as written. Statements that are missing keep these defaults.
struct MtlStatements {
    float diffuse[3] = {0.8f, 0.8f, 0.8f}, specular[3] = {0, 0, 0}, emission[3] = {0, 0, 0}, filter[3] = {1, 1, 1};
    float exponent = 1, ior = 1, dissolve = 1;
    bool has_diffuse = false, has_specular = false, has_dissolve = false, has_filter = false;
    int illumination = -1;
    ObjTexture texture, dissolve_map, specular_map, emission_map, normal_map, bump_map, filter_map;
    std::array<std::optional<float>, kPbrCount> pbr;
    std::array<ObjTexture, kPbrCount> pbr_maps;
};

ObjMaterial to_material(const MtlStatements& statements);

}  // namespace openmesh_import
