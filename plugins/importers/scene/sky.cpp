#include "sky.hpp"

#include <algorithm>
#include <cstring>

#include "diagnostics.hpp"
#include "looks.hpp"

namespace scene_format {
namespace {

// Sets the member of a description that a key of the host's table names.
void set_member(rt_sky_desc& sky, const rt_key& key, const Vec3& value) {
    const auto is = [&](const char* name) { return std::strcmp(key.name, name) == 0; };
    if (is("visible")) sky.hidden = value[0] == 0 ? 1 : 0;
    float* const to = is("rotate")                  ? &sky.rotate_deg
                      : is("strength")              ? &sky.strength
                      : is("horizon")               ? sky.horizon
                      : is("ground")                ? sky.ground
                      : is("color") || is("zenith") ? sky.color
                                                    : nullptr;
    if (to) std::copy_n(value.begin(), key.kind == RT_KEY_COLOR ? 3 : 1, to);
}

}  // namespace

void read_sky(Statement& s, Document& document, Diagnostics&) {
    if (document.sky.position.line != 0)
        throw StatementError{s.position(), "statement `sky` for the second time; the first is in line " +
                                               std::to_string(document.sky.position.line)};
    Sky sky;
    sky.position = s.position();
    rt_sky_desc& values = sky.values;
    values.strength = 1;
    std::fill_n(values.color, 3, 1.f);
    const std::string first = s.path("the path of a picture, `constant` or `gradient`");
    values.kind = first == "constant" ? RT_SKY_CONSTANT : first == "gradient" ? RT_SKY_GRADIENT : RT_SKY_PICTURE;
    if (values.kind == RT_SKY_PICTURE) sky.path = first;
    const std::vector<const rt_key*> keys = keys_of(*document.kinds.skies.at(values.kind));
    expect(s, keys);
    if (values.kind == RT_SKY_CONSTANT && !s.at_key())
        set_member(values, *keys.front(), s.color("the sky's radiance (r g b)", static_cast<float>(keys.front()->max)));
    while (!s.done()) {
        const rt_key& key = *keys[s.key()];
        set_member(values, key, read_look(s, key));
    }
    document.sky = sky;
}

void read_sky_edits(Statement& s, Document& document) {
    std::vector<std::string_view> names = {"background"};
    for (const rt_primitive_kind* kind : document.kinds.skies) names.push_back(kind->id);
    const size_t kind = s.choice("kind of sky", names);
    document.edits.push_back({"sky", std::string(names[kind]), s.position()});
    if (kind == 0) return s.expect_end();
    const std::vector<const rt_key*> keys = keys_of(*document.kinds.skies[kind - 1]);
    expect(s, keys);
    while (!s.done()) {
        const rt_key& key = *keys[s.key()];
        document.edits.push_back({std::string("sky.") + key.name, look_text(key, read_look(s, key)), s.position()});
    }
}

}  // namespace scene_format
