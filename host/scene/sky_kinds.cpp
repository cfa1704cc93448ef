#include "scene/sky_kinds.hpp"

#include <algorithm>
#include <cstring>

namespace clarity {
namespace {

using S = SkyValues;

// More would overflow where a strength multiplies it.
constexpr double kMostRadiance = 1e12, kMostTurn = 1e6;

Key radiance_key(const char* name, const char* label, size_t offset, float grey, const char* more) {
    return shown(color_key(name, offset, kMostRadiance, grey), label, "r g b", more);
}

std::vector<SkyKind> make_sky_kinds() {
    Key strength =
        shown(number_key("strength", offsetof(S, strength), 0, kMostRadiance, 1), "Strength", "factor of all radiance");
    strength.step = 0.01f;
    Key rotate = shown(number_key("rotate", offsetof(S, rotate_deg), -kMostTurn, kMostTurn, 0), "Rotation", "degrees",
                       "turns it about +Y, counter-clockwise seen from above");
    rotate.step = 0.5f;
    Key no_effect = rotate;
    no_effect.more = "no effect, because it is alike all around";
    no_effect.alias = true;
    const Key visible = shown(flag_key("visible", offsetof(S, hidden), 1, true), "Visible", "whether the camera sees it",
                              "if not, its rays see `background`");
    return {
        {RT_NONE, "background", "background", "the background's colour lights the scene, too", {}},
        {RT_SKY_CONSTANT,
         "constant",
         "one colour",
         "the same from all directions",
         {radiance_key("color", "Sky's colour", offsetof(S, color), 1, "radiance of all directions"), strength, no_effect,
          visible}},
        {RT_SKY_GRADIENT,
         "gradient",
         "gradient",
         "from `horizon` to `zenith` in proportion to the sine of the elevation",
         {radiance_key("zenith", "Zenith", offsetof(S, color), 1, "radiance straight up"),
          radiance_key("horizon", "Horizon", offsetof(S, horizon), 0, "radiance at the horizon"),
          radiance_key("ground", "Ground", offsetof(S, ground), 0, "radiance from below the horizon"), strength, no_effect,
          visible}},
        {RT_SKY_PICTURE, "picture", "picture", "the file's picture of all directions", {strength, rotate, visible}},
    };
}

}  // namespace

const std::vector<SkyKind>& sky_kinds() {
    static const std::vector<SkyKind> kinds = make_sky_kinds();
    return kinds;
}

const SkyKind& sky_kind_of(rt_u32 kind) {
    const std::vector<SkyKind>& kinds = sky_kinds();
    const auto row = std::find_if(kinds.begin(), kinds.end(), [&](const SkyKind& k) { return k.kind == kind; });
    return row == kinds.end() ? kinds.front() : *row;
}

const rt_primitive_kind* sky_kind_for_plugins(rt_u32 kind) {
    static const std::vector<PluginKeys> all = [] {
        std::vector<PluginKeys> rows;
        for (const SkyKind& row : sky_kinds())
            if (row.kind != RT_NONE) rows.emplace_back(row.name, row.keys);
        return rows;
    }();
    return kind < all.size() ? &all[kind].kind : nullptr;
}

bool same_sky(const SkyValues& a, const SkyValues& b) {
    static_assert(sizeof(SkyValues) == 15 * 4, "bytes between members would be compared");
    return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace clarity
