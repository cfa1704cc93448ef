#include "scene/map_uses.hpp"

#include <algorithm>
#include <vector>

namespace clarity {

const std::array<MapUse, RT_MAP_USES>& map_uses() {
    // Channels and colour spaces are those of Khronos' specification of glTF 2.0 and of its extensions KHR_materials_*.
    static constexpr std::array<MapUse, RT_MAP_USES> uses = {{
        {"color_map", "Colour", "r g b; its alpha multiplies the opacity", RT_SPACE_SRGB, {"color"}},
        {"emission_map", "Emission", "r g b", RT_SPACE_SRGB, {"emission"}},
        {"normal_map",
         "Normals",
         "r g b is the direction along u, v and the normal: 2 r - 1, 2 g - 1, 2 b - 1",
         RT_SPACE_LINEAR,
         {}},
        {"occlusion_map", "Occlusion", "r is the share of `ambient` that arrives", RT_SPACE_LINEAR, {}},
        {"metallic_roughness_map",
         "Metal, roughness",
         "g is for the roughness, b for the share of metal",
         RT_SPACE_LINEAR,
         {"roughness", "metallic"}},
        {"transmission_map", "Transmission", "r", RT_SPACE_LINEAR, {"transmission"}},
        {"thickness_map", "Thickness", "g; `path` finds itself how thick a solid is", RT_SPACE_LINEAR, {}},
        {"clearcoat_map", "Clearcoat", "r", RT_SPACE_LINEAR, {"clearcoat"}},
        {"clearcoat_roughness_map", "Coat roughness", "g", RT_SPACE_LINEAR, {"clearcoat_roughness"}},
        {"clearcoat_normal_map", "Coat normals", "as `normal_map`, of the varnish", RT_SPACE_LINEAR, {}},
        {"specular_weight_map", "Reflection", "the alpha", RT_SPACE_LINEAR, {"specular_weight"}},
        {"specular_color_map", "Reflection colour", "r g b", RT_SPACE_SRGB, {"specular_color"}},
        {"sheen_color_map", "Sheen", "r g b", RT_SPACE_SRGB, {"sheen_color"}},
        {"sheen_roughness_map", "Sheen roughness", "the alpha", RT_SPACE_LINEAR, {"sheen_roughness"}},
        {"anisotropy_map",
         "Anisotropy",
         "2 r - 1, 2 g - 1 is the direction of the grain, b is for the strength",
         RT_SPACE_LINEAR,
         {"anisotropy"}},
        {"iridescence_map", "Iridescence", "r", RT_SPACE_LINEAR, {"iridescence"}},
        {"iridescence_thickness_map",
         "Film thickness",
         "g leads from `iridescence_thickness_min` to `iridescence_thickness`",
         RT_SPACE_LINEAR,
         {}},
        {"opacity_map", "Opacity", "r", RT_SPACE_LINEAR, {"opacity"}},
        {"roughness_map",
         "Roughness",
         "r; `metallic_roughness_map` does not count for it then",
         RT_SPACE_LINEAR,
         {"roughness"}},
        {"metallic_map", "Metal", "r; `metallic_roughness_map` does not count for it then", RT_SPACE_LINEAR, {"metallic"}},
    }};
    return uses;
}

rt_u32 find_map_use(const std::string& name) {
    for (rt_u32 use = 0; use < RT_MAP_USES; ++use)
        if (name == map_uses()[use].name) return use;
    return RT_NONE;
}

bool lies_plainly(const rt_map& map) {
    const float identity[] = {1, 0, 0, 0, 1, 0};
    return std::equal(identity, identity + 6, map.matrix);
}

const rt_primitive_kind* map_kind_for_plugins() {
    static const std::vector<rt_key> keys = [] {
        std::vector<rt_key> rows;
        for (const MapUse& use : map_uses())
            rows.push_back({use.name, use.help, RT_KEY_TEXTURE, 0, 0, 0, {double(use.space)}, use.multiplies.data()});
        return rows;
    }();
    static const rt_primitive_kind kind = {sizeof kind, RT_MAP_USES, "map", keys.data(), sizeof(rt_key), 0};
    return &kind;
}

}  // namespace clarity
