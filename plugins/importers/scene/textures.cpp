#include "textures.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "../common/numbers.hpp"
#include "diagnostics.hpp"
#include "looks.hpp"
#include "rt_plugin.hpp"

namespace scene_format {
namespace {

constexpr float kMostStrength = 1000;

// One number for both directions, or two.
std::array<float, 2> read_scale(Statement& s) {
    const Position start = s.next();
    const std::vector<float> numbers = s.numbers("`scale` (of u and v, or one for both)", 1, -kMaxNumber, kMaxNumber);
    const std::array<float, 2> scale = {numbers.front(), numbers.back()};
    if (numbers.size() > 2 || scale[0] == 0 || scale[1] == 0)
        throw StatementError{start, "expected one or two numbers other than 0 for `scale` (of u and v, or one for both)"};
    return scale;
}

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

void read_wrap(Statement& s, rt_u32& along_u, rt_u32& along_v) {
    const std::vector<std::string_view> modes = {"repeat", "clamp", "mirror"};
    along_u = along_v = static_cast<rt_u32>(s.choice("wrap mode", modes));
    if (!s.done() && !s.at_key()) along_v = static_cast<rt_u32>(s.choice("wrap mode along v", modes));
}

void read_texture(Statement& s, Document& document, Diagnostics&) {
    enum { kSpace, kWrap, kFilter, kUv, kOffset, kRotate, kScale, kStrength };
    s.expect_keys({{"space"}, {"wrap"}, {"filter"}, {"uv"}, {"offset"}, {"rotate"}, {"scale"}, {"strength"}});
    // As of materials: an error in a key is no error of each use of the name.
    Texture& texture = document.textures.emplace_back();
    texture.name = s.name("the texture's name");
    texture.path = s.path("the picture's file");
    while (!s.done()) {
        switch (s.key()) {
            case kSpace:
                texture.space =
                    static_cast<rt_u32>(s.choice("colour space", {"srgb", "linear", "height", "alpha", "clearness"}));
                break;
            case kWrap:
                read_wrap(s, texture.wrap_u, texture.wrap_v);
                break;
            case kFilter:
                texture.filter = static_cast<rt_u32>(s.choice("filter", {"smooth", "nearest"}));
                break;
            case kUv:
                texture.set = static_cast<rt_u32>(s.choice("set of texture coordinates", {"0", "1"}));
                break;
            case kOffset:
                for (size_t i = 0; i < 2; ++i) texture.offset[i] = s.number("`offset` (u v)", i, 2);
                break;
            case kRotate:
                texture.degrees = s.number("`rotate` (degrees)");
                break;
            case kScale:
                texture.scale = read_scale(s);
                break;
            case kStrength:
                texture.strength = s.number_between("`strength`", -kMostStrength, kMostStrength);
                break;
        }
    }
}

rt_map_desc map_of(const Texture& texture, rt_u32 use, rt_u32 id) {
    rt_map_desc map = rt::map(use, id);
    map.set = texture.set;
    if (use == RT_MAP_NORMAL || use == RT_MAP_CLEARCOAT_NORMAL || use == RT_MAP_OCCLUSION) map.scale = texture.strength;
    const double angle = texture.degrees * importers::kRadPerDegree, c = std::cos(angle), s = std::sin(angle);
    const double matrix[6] = {c * texture.scale[0], -s * texture.scale[1], texture.offset[0],
                              s * texture.scale[0], c * texture.scale[1],  texture.offset[1]};
    for (int k = 0; k < 6; ++k) map.matrix[k] = static_cast<float>(matrix[k]);
    return map;
}

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
