#include "view/edit/sky_edit.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "scene/sky_kinds.hpp"
#include "scene/vec.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity {
bool is_possible_sky(const Scene& scene, rt_u32 kind) {
    return kind != RT_SKY_PICTURE || scene.sky.values.kind == RT_SKY_PICTURE;
}

void read_sky(const Scene& scene, View& view, const std::string& key, const std::string& value) {
    SkyValues sky = sky_of(scene, view);
    if (key == "sky") {
        std::string names;
        for (const SkyKind& kind : sky_kinds()) {
            if (value == kind.name && is_possible_sky(scene, kind.kind)) {
                sky.kind = kind.kind;
                view.sky = sky;
                return;
            }
            if (is_possible_sky(scene, kind.kind)) names += (names.empty() ? "" : " or ") + std::string(kind.name);
        }
        refuse_value(key, value, names + (value == "picture" ? ": the scene's files name no picture of a sky" : ""));
    }
    const SkyKind& kind = sky_kind_of(sky.kind);
    const Key* const part = find_key(kind.keys, key.substr(4));
    if (!part) {
        std::string names;
        for (const Key& row : kind.keys) names += (names.empty() ? "" : ", ") + std::string(row.name);
        throw Error(Exit::usage, key + ": a sky of the kind " + kind.name + " has the parts " +
                                     (names.empty() ? "none" : names) + "; `sky=KIND` chooses another kind");
    }
    std::array<float, 3> numbers{};
    std::string expected;
    if (!read_value(*part, value, numbers, expected)) refuse_value(key, value, expected);
    set_value(*part, &sky, numbers);
    view.sky = sky;
}

void choose_sky_kind(const Scene& scene, const View& view, rt_u32 kind, SkyValues& sky) {
    if (!is_possible_sky(scene, kind)) return;
    if (sky.kind == RT_NONE && kind != RT_SKY_PICTURE) std::copy(view.background.begin(), view.background.end(), sky.color);
    if (kind == RT_SKY_GRADIENT && is_black(sky.horizon) && is_black(sky.ground)) {
        std::copy_n(sky.color, 3, sky.horizon);
        std::copy_n(sky.color, 3, sky.ground);
    }
    sky.kind = kind;
}

void add_sky_words(const SkyValues& was, const SkyValues& is, std::vector<Word>& words) {
    const SkyKind& kind = sky_kind_of(is.kind);
    if (is.kind != was.kind) words.push_back({"sky", kind.name});
    for (const Key& key : kind.keys) {
        const std::array<float, 3> value = value_of(key, &is);
        if (!key.alias && value != value_of(key, &was))
            words.push_back({std::string("sky.") + key.name, value_text(key, value, ",")});
    }
}

std::string sky_line(const SkyValues& sky) {
    const SkyKind& kind = sky_kind_of(sky.kind);
    std::string line = kind.name;
    for (const Key& key : kind.keys)
        if (!key.alias) line += "  " + std::string(key.name) + " " + value_text(key, value_of(key, &sky), " ");
    return line;
}

}  // namespace clarity
