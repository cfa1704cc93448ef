#include "scene/light_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "base/angle.hpp"
#include "scene/usable.hpp"

namespace clarity {
namespace {

using L = rt_light;

constexpr const char* kFalloffs[] = {"none", "square", nullptr};

Key direction_key(size_t offset, bool towards_light) {
    Key key =
        shown(vector_key("direction", offset, {0, -1, 0}), "Direction", "x y z, in which the light travels", "any length");
    key.moves = Moves::direction;
    key.inverted = towards_light;
    return key;
}
Key place_key(const char* name, const char* help) {
    return shown(point_key(name, offsetof(L, position), {0, 10, 0}), "Position", "x y z", help);
}
Key light_color(const char* name, const char* label, const char* more) {
    return shown(color_key(name, offsetof(L, color), kMostNumber, 1), label, "r g b", more);
}
Key falloff_key() {
    return shown(
        word_key("falloff", offsetof(L, flags), RT_LIGHT_FALLOFF, kFalloffs), "Falloff", "how light fades with the distance",
        "`none`: not at all, as Whitted has it; the colour is an irradiance divided by pi. `square`: by the inverse square; "
        "the colour is an intensity, W/sr");
}
Key range_key() {
    Key key = shown(number_key("range", offsetof(L, range), 0, kMostNumber, 0), "Range", "where light that falls off ends",
                    "0: nowhere");
    key.moves = Moves::length;
    return key;
}
Key angle_key(const char* name, size_t offset, double max, float def, const char* help, const char* more) {
    return shown(number_key(name, offset, 0, max, def), std::strcmp(name, "inner") == 0 ? "Inner angle" : "Angle", help, more);
}
Key length_key(const char* name, size_t offset) {
    Key key = shown(number_key(name, offset, 1e-12, kMostNumber, 1), "Radius", "greater than 0");
    key.moves = Moves::length;
    key.logarithmic = true;
    return key;
}
Key edge_key(const char* name, size_t offset, const std::array<float, 3>& def) {
    return shown(vector_key(name, offset, def), name, "x y z, half an edge",
                 "corners are center +- u +- v; it emits to the side of u x v");
}
Key two_sided_key() {
    return shown(flag_key("two_sided", offsetof(L, flags), RT_LIGHT_TWO_SIDED), "Two-sided", "whether both sides emit");
}
Key alias(Key key) {
    key.alias = true;
    return key;
}

// Half of an angle in degrees, in radians.
double half(float degrees) {
    return 0.5 * degrees * kRadPerDegree;
}
double sides(const rt_light& light) {
    return light.flags & RT_LIGHT_TWO_SIDED ? 2 : 1;
}

void complete_spot(rt_light& light) {
    light.cos_outer = static_cast<float>(std::cos(half(light.angle)));
    light.cos_inner = static_cast<float>(std::cos(half(std::min(light.inner, light.angle))));
}
void complete_sun(rt_light& light) {
    const double sine = std::sin(half(light.angle));
    light.cos_outer = static_cast<float>(std::cos(half(light.angle)));
    light.radius = static_cast<float>(sine);
    light.area = static_cast<float>(kPi * sine * sine);
}
// Areas of all sides that emit.
double area_of_rect(const rt_light& light) {
    return 4 * length(cross(to_vec(light.u), to_vec(light.v))) * sides(light);
}
double area_of_disc(const rt_light& light) {
    return kPi * light.radius * double(light.radius) * sides(light);
}
double area_of_sphere(const rt_light& light) {
    return 4 * kPi * light.radius * double(light.radius);
}
void complete_rect(rt_light& light) {
    const Vec n = cross(to_vec(light.u), to_vec(light.v));
    const double size = length(n);
    for (int k = 0; k < 3; ++k) light.normal[k] = size > 0 ? static_cast<float>(n[k] / size) : 0;
    light.area = static_cast<float>(area_of_rect(light));
}
void complete_disc(rt_light& light) {
    light.area = static_cast<float>(area_of_disc(light));
}
void complete_sphere(rt_light& light) {
    light.area = static_cast<float>(area_of_sphere(light));
}

// Powers: see LightKind::power. Without falloff a colour is an irradiance divided by pi, at any distance.
double cross_section(double radius) {
    return kPi * radius * radius;
}
bool fades(const rt_light& light) {
    return (light.flags & RT_LIGHT_FALLOFF) != 0;
}
double power_of_point(const rt_light& light, double radius) {
    return fades(light) ? 4 * kPi : kPi * cross_section(radius);
}
double power_of_spot(const rt_light& light, double radius) {
    return fades(light) ? 2 * kPi * (1 - 0.5 * (double(light.cos_inner) + light.cos_outer)) : kPi * cross_section(radius);
}
double power_of_directional(const rt_light& light, double radius) {
    return (fades(light) ? 1 : kPi) * cross_section(radius);
}
double power_of_sun(const rt_light&, double radius) {
    return cross_section(radius);
}
double power_of_rect(const rt_light& light, double) {
    return kPi * area_of_rect(light);
}
double power_of_disc(const rt_light& light, double) {
    return kPi * area_of_disc(light);
}
double power_of_sphere(const rt_light& light, double) {
    return kPi * area_of_sphere(light);
}

LightKind kind(rt_u32 number, const char* name, const char* label, const char* help, double (*power)(const rt_light&, double),
               std::vector<Key> keys) {
    LightKind row;
    row.kind = number, row.name = name, row.label = label, row.help = help, row.power = power, row.keys = std::move(keys);
    return row;
}
LightKind far_away(LightKind row) {
    row.has_place = false;
    return row;
}
LightKind with_size(LightKind row) {
    row.has_size = true;
    return row;
}
LightKind completed(LightKind row, void (*complete)(rt_light&)) {
    row.complete = complete;
    return row;
}

std::vector<LightKind> make_kinds() {
    const Key normal = [] {
        Key key = shown(vector_key("normal", offsetof(L, normal), {0, -1, 0}), "Normal", "x y z, of the side that emits",
                        "any length");
        key.moves = Moves::direction;
        return key;
    }();
    // Lights far away hold the direction towards them.
    const Key towards = direction_key(offsetof(L, position), true), into = direction_key(offsetof(L, normal), false);
    const Key color = light_color("color", "Light colour", "linear, 0 or more");
    const Key irradiance = light_color("irradiance", "Irradiance", "of a surface that faces it, linear");
    const Key radiance = light_color("radiance", "Radiance", "linear, 0 or more");
    const size_t angle = offsetof(L, angle), inner = offsetof(L, inner), radius = offsetof(L, radius);
    Key legacy = towards;
    legacy.reversed_in_edits = true;
    return {
        kind(RT_LIGHT_POINT, "point", "lamp", "a point", power_of_point,
             {place_key("position", "where it is"), color, falloff_key(), range_key()}),
        far_away(
            kind(RT_LIGHT_DIRECTIONAL, "directional", "directional", "parallel light", power_of_directional, {legacy, color})),
        completed(kind(RT_LIGHT_SPOT, "spot", "spot", "a point with a cone", power_of_spot,
                       {place_key("position", "where it is"), into, color,
                        angle_key("angle", angle, 180, 60, "degrees", "of the whole cone; beyond it there is no light"),
                        angle_key("inner", inner, 180, 45, "degrees", "of the cone within which it has its full intensity"),
                        falloff_key(), range_key()}),
                  complete_spot),
        completed(far_away(kind(RT_LIGHT_SUN, "sun", "sun", "a disc in the sky", power_of_sun,
                                {towards, irradiance, alias(light_color("color", "Irradiance", "another name of `irradiance`")),
                                 angle_key("angle", angle, 180, 0.53f, "degrees", "across; that of the sun is 0.53")})),
                  complete_sun),
        completed(with_size(kind(RT_LIGHT_RECT, "rect", "rectangle", "a parallelogram that shines", power_of_rect,
                                 {place_key("center", "its middle"), edge_key("u", offsetof(L, u), {1, 0, 0}),
                                  edge_key("v", offsetof(L, v), {0, 0, 1}), radiance, two_sided_key()})),
                  complete_rect),
        completed(with_size(kind(
                      RT_LIGHT_DISC, "disc", "disc", "a disc that shines", power_of_disc,
                      {place_key("center", "its middle"), normal, length_key("radius", radius), radiance, two_sided_key()})),
                  complete_disc),
        completed(with_size(kind(RT_LIGHT_SPHERE, "sphere", "sphere", "a ball that shines", power_of_sphere,
                                 {place_key("center", "its middle"), length_key("radius", radius), radiance})),
                  complete_sphere),
    };
}

Vec vec_at(const rt_light& light, const Key& key) {
    return to_vec(value_of(key, &light));
}

}  // namespace

const std::vector<LightKind>& light_kinds() {
    static const std::vector<LightKind> kinds = [] {
        std::vector<LightKind> rows = make_kinds();
        for (rt_u32 i = 0; i < RT_LIGHT_KINDS; ++i)
            if (rows.size() != RT_LIGHT_KINDS || rows[i].kind != i)
                throw std::logic_error("the kinds of lights are not in the order of their numbers");
        return rows;
    }();
    return kinds;
}

const LightKind& light_kind_of(const rt_light& light) {
    return light_kinds().at(light.kind);  // validate() has looked at it
}

const LightKind* find_light_kind(const std::string& name) {
    for (const LightKind& kind : light_kinds())
        if (kind.name == name) return &kind;
    return nullptr;
}

const rt_primitive_kind* light_kind_for_plugins(rt_u32 kind) {
    static const std::vector<PluginKeys> all = [] {
        std::vector<PluginKeys> rows;
        for (const LightKind& row : light_kinds()) rows.emplace_back(row.name, row.keys);
        return rows;
    }();
    return kind < all.size() ? &all[kind].kind : nullptr;
}

rt_light default_light(rt_u32 kind) {
    rt_light light{};
    light.kind = kind;
    for (const Key& key : light_kind_of(light).keys) set_value(key, &light, key.def);
    make_sound(light);
    return light;
}

bool light_of(const rt_light_desc& d, rt_light& light, std::string& problem) {
    light = default_light(d.kind);
    const std::vector<Key>& keys = light_kind_of(light).keys;
    const auto set = [&](const Key& key, const float* n) { set_value(key, &light, {n[0], n[1], n[2]}); };
    for (const Key& key : keys) {
        if (key.moves == Moves::point) set(key, d.position);
        if (std::strcmp(key.name, "direction") == 0) set(key, d.direction);
        if (key.kind == RT_KEY_COLOR) set(key, d.color);
    }
    problem.clear();
    for (rt_u32 i = 0; d.values && i < d.value_count; ++i) {
        const rt_key_value& value = d.values[i];
        const Key* key = value.key ? find_key(keys, value.key) : nullptr;
        if (!key) {
            problem = "has a key that this host does not know, which is left out";
        } else if (count_of(*key) == 3) {
            set(*key, value.numbers);
        } else {
            set_value(*key, &light, nearest_value(*key, {value.numbers[0], 0, 0}));
        }
    }
    rt_light sound = light;
    return make_sound(sound);
}

bool make_sound(rt_light& light, bool keep_units) {
    const LightKind& row = light_kind_of(light);
    for (const Key& key : row.keys) {
        const std::array<float, 3> value = value_of(key, &light);
        if (!are_usable(value) || (key.moves == Moves::length && range_fault(key, value))) return false;
        if (key.kind == RT_KEY_COLOR) set_value(key, &light, nearest_value(key, value));
        if (key.kind != RT_KEY_VECTOR) continue;
        const double size = length(to_vec(value));
        if (!(size > 0)) return false;
        if (key.moves != Moves::direction || (keep_units && std::abs(size - 1) <= 1e-6)) continue;
        set_value(key, &light, to_floats({value[0] / size, value[1] / size, value[2] / size}));
    }
    if (row.complete) row.complete(light);
    light.flags &= ~RT_LIGHT_STAND_IN;  // a light that somebody has set is one of the scene
    return std::isfinite(light.area) && (row.kind != RT_LIGHT_RECT || light.area > 0);
}

bool move_light(rt_light& light, const Matrix& m) {
    const double scale = std::cbrt(std::abs(determinant(m)));
    for (const Key& key : light_kind_of(light).keys) {
        if (key.alias) continue;
        const Vec value = vec_at(light, key);
        if (key.moves == Moves::point) set_value(key, &light, to_floats(point(m, value)));
        if (key.moves == Moves::direction || key.moves == Moves::vector) set_value(key, &light, to_floats(direction(m, value)));
        if (key.moves == Moves::length) set_value(key, &light, {static_cast<float>(scale * value[0]), 0, 0});
    }
    return make_sound(light);
}

std::array<float, 3> edit_value(const Key& key, const rt_light& light) {
    std::array<float, 3> value = value_of(key, &light);
    for (float& x : value) x = key.reversed_in_edits ? -x : x;
    return value;
}

void set_edit_value(const Key& key, rt_light& light, std::array<float, 3> value) {
    for (float& x : value) x = key.reversed_in_edits ? -x : x;
    set_value(key, &light, value);
}

Problem light_fault(const rt_light& light) {
    if (light.kind >= light_kinds().size()) return "unknown kind " + std::to_string(light.kind);
    return fault_of(light_kind_of(light).keys, &light);
}

}  // namespace clarity
