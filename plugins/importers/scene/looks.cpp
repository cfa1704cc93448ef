#include "looks.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>

#include "shapes.hpp"
#include "textures.hpp"

namespace scene_format {
namespace {

std::string_view word_of(const rt_key& key, const Vec3& value) {
    return key.kind == RT_KEY_FLAG ? (value[0] != 0 ? "true" : "false") : key.words[static_cast<size_t>(value[0])];
}
bool is_word(const rt_key& key) {
    return key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG;
}
size_t count_of(const rt_key& key) {
    return key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR || key.kind == RT_KEY_COLOR ? 3 : 1;
}
bool is_named(const rt_key& key, const char* name) {
    return std::strcmp(key.name, name) == 0;
}

Vec3 default_of(const rt_key& key) {
    return {static_cast<float>(key.def[0]), static_cast<float>(key.def[1]), static_cast<float>(key.def[2])};
}

// Reads the kind of a light. before: words that may stand in its place; returns the index of one of them, or nothing.
const rt_primitive_kind* read_kind(Statement& s, const Document& document, std::vector<std::string_view> before,
                                   const char* what, size_t& index) {
    const size_t others = before.size();
    for (const rt_primitive_kind* kind : document.kinds.lights) before.push_back(kind->id);
    index = s.choice(what, before);
    return index < others ? nullptr : document.kinds.lights[index -= others];
}

void set_value(Looks& values, const char* key, const Vec3& value) {
    values.push_back({key, {value[0], value[1], value[2]}, 0});
}

// Brings shares that add up to more than 1 down to it.
void share(Looks& values, const Name& material, Position refract_position, Diagnostics& diagnostics) {
    rt_key_value *reflect = nullptr, *refract = nullptr;
    for (rt_key_value& value : values) {
        if (std::strcmp(value.key, "reflect") == 0) reflect = &value;
        if (std::strcmp(value.key, "refract") == 0) refract = &value;
    }
    if (!reflect || !refract) return;
    const float sum = reflect->numbers[0] + refract->numbers[0];
    if (!(sum > 1)) return;
    // .1 + .9 is not exactly 1, so a small excess is no reason for a warning.
    if (sum > 1.0001f) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "`reflect` and `refract` of material %s add up to %g; both are scaled down to add up to 1",
                      in_quotes(material.text).c_str(), static_cast<double>(sum));
        diagnostics.warning(refract_position, text);
    }
    reflect->numbers[0] /= sum;
    refract->numbers[0] = 1 - reflect->numbers[0];
}

}  // namespace

std::vector<const rt_key*> keys_of(const rt_primitive_kind& kind) {
    std::vector<const rt_key*> keys;
    for (size_t i = 0; i < kind.key_count; ++i) keys.push_back(&key_of(kind, i));
    return keys;
}

void expect(Statement& s, const std::vector<const rt_key*>& keys, const std::vector<Key>& more) {
    std::vector<Key> all;
    for (const rt_key* key : keys) all.push_back({key->name});
    all.insert(all.end(), more.begin(), more.end());
    s.expect_keys(all);
}

Vec3 read_look(Statement& s, const rt_key& key) {
    const std::string what = std::string("`") + key.name + "` (" + key.help + ")";
    if (key.kind == RT_KEY_COLOR) return s.color(what, static_cast<float>(key.max));
    if (is_named(key, "direction")) return s.direction(what);
    if (key.kind == RT_KEY_FLAG) {
        if (s.done() || s.at_key()) return {1, 0, 0};
        return {static_cast<float>(s.choice("value of `" + std::string(key.name) + "`", {"false", "true"})), 0, 0};
    }
    if (key.kind == RT_KEY_WORD) {
        std::vector<std::string_view> words;
        for (const char* const* word = key.words; *word; ++word) words.push_back(*word);
        return {static_cast<float>(s.choice(key.name, words)), 0, 0};
    }
    const std::vector<float> numbers = read_values(s, key);
    Vec3 value{};
    std::copy_n(numbers.begin(), std::min<size_t>(numbers.size(), 3), value.begin());
    return value;
}

std::string look_text(const rt_key& key, const Vec3& value) {
    return is_word(key) ? std::string(word_of(key, value)) : text_of(value.data(), count_of(key));
}

std::string text_of(const float* numbers, size_t count) {
    std::string text;
    for (size_t i = 0; i < count; ++i) {
        char digits[32];
        const auto end = std::to_chars(digits, digits + sizeof digits, numbers[i]).ptr;
        text += (i == 0 ? "" : ",") + std::string(digits, end);
    }
    return text;
}

void read_light(Statement& s, Document& document, Diagnostics&) {
    size_t number = 0;
    const std::vector<const rt_key*> keys = keys_of(*read_kind(s, document, {}, "kind of light", number));
    expect(s, keys, {{"intensity"}, {"name"}});
    Light light;
    rt_light_desc& desc = light.values;
    desc.kind = static_cast<rt_u32>(number);
    // Three of the values are members of the description.
    const auto member = [&](const rt_key& key) -> float* {
        return key.kind == RT_KEY_POINT     ? desc.position
               : key.kind == RT_KEY_COLOR   ? desc.color
               : is_named(key, "direction") ? desc.direction
                                            : nullptr;
    };
    for (const rt_key* key : keys)
        if (float* to = member(*key)) {
            const Vec3 value = default_of(*key);
            std::copy(value.begin(), value.end(), to);
        }
    float intensity = 1;
    while (!s.done()) {
        const size_t i = s.key();
        if (i == keys.size()) {
            intensity = s.number_between("`intensity`", 0, 1e9f);
        } else if (i > keys.size()) {
            light.name = s.name("the light's name");
        } else {
            const Vec3 value = read_look(s, *keys[i]);
            if (float* to = member(*keys[i]))
                std::copy(value.begin(), value.end(), to);
            else
                set_value(light.looks, keys[i]->name, value);
        }
    }
    for (float& c : desc.color) {
        c *= intensity;
        if (!(c <= kMaxNumber)) s.fail_at_last("its colour times `intensity` is out of range; expected 1e+15 at most");
    }
    document.lights.push_back(std::move(light));
}

void read_material(Statement& s, Document& document, Diagnostics& diagnostics) {
    const std::vector<const rt_key*> keys = keys_of(*document.kinds.material);
    const std::vector<const rt_key*> maps = keys_of(*document.kinds.maps);
    std::vector<Key> more = {{"texture"}, {"wrap"}};
    for (const rt_key* map : maps) more.push_back({map->name});
    expect(s, keys, more);
    const size_t texture = keys.size(), first_map = texture + 2;
    // Register the name before the keys are read, so that an error in a key does not make every use of the name an error.
    Material& material = document.materials.emplace_back();
    material.name = s.name("the material's name");
    Position refract_position = material.name.position, wrap_position;
    const auto two_colors = [&] {
        s.fail_at_last("`texture` and `color_map` are two textures of the colour; expected one of them");
    };
    while (!s.done()) {
        const size_t i = s.key();
        if (i == texture) {
            material.texture = s.path("the texture's file");
            if (s.given(first_map + RT_MAP_COLOR)) two_colors();
        } else if (i >= first_map) {
            material.maps.push_back({static_cast<rt_u32>(i - first_map), s.name("the name of a texture")});
            if (i - first_map == RT_MAP_COLOR && s.given(texture)) two_colors();
        } else if (i > texture) {
            wrap_position = s.next();
            read_wrap(s, material.wrap_u, material.wrap_v);
        } else {
            set_value(material.looks, keys[i]->name, read_look(s, *keys[i]));
            if (is_named(*keys[i], "refract")) refract_position = s.last();
        }
    }
    // A texture multiplies keys. Where they are not given, 1 leaves the texture unchanged.
    const auto show_unchanged = [&](const rt_key& map) {
        for (const char* const* name = map.words; name && *name; ++name)
            for (size_t i = 0; i < keys.size(); ++i)
                if (is_named(*keys[i], *name) && !s.given(i)) set_value(material.looks, *name, {1, 1, 1});
    };
    if (!material.texture.empty()) show_unchanged(*maps[RT_MAP_COLOR]);
    for (const auto& [use, name] : material.maps) show_unchanged(*maps[use]);
    if (wrap_position.line != 0 && material.texture.empty())
        diagnostics.warning(wrap_position,
                            "`wrap` has no effect, because material " + in_quotes(material.name.text) + " has no `texture`");
    share(material.looks, material.name, refract_position, diagnostics);
}

void read_material_edits(Statement& s, const std::string& prefix, Document& document) {
    const std::vector<const rt_key*> keys = keys_of(*document.kinds.material), maps = keys_of(*document.kinds.maps);
    std::vector<Key> more;
    for (const rt_key* map : maps) more.push_back({map->name});
    expect(s, keys, more);
    while (!s.done()) {
        const size_t i = s.key();
        if (i >= keys.size()) {
            const size_t use = i - keys.size();
            const Name name = s.name("the name of a texture, or none");
            document.edits.push_back({prefix + maps[use]->name, name.text, s.position(), static_cast<rt_u32>(use)});
            continue;
        }
        const rt_key& key = *keys[i];
        const Vec3 value = read_look(s, key);
        document.edits.push_back({prefix + key.name, look_text(key, value), s.position()});
    }
}

void read_light_edits(Statement& s, const std::string& key, Document& document) {
    size_t number = 0;
    const rt_primitive_kind* kind = read_kind(s, document, {"off"}, "`off` or kind of light", number);
    if (!kind) {
        s.expect_end();
        document.edits.push_back({key, "off", s.position()});
        return;
    }
    const std::vector<const rt_key*> keys = keys_of(*kind);
    expect(s, keys);
    std::vector<Vec3> values;
    std::vector<size_t> places;  // of each key's value: a light has one colour, which may have two names
    size_t color = keys.size();
    for (size_t i = 0; i < keys.size(); ++i) {
        values.push_back(default_of(*keys[i]));
        const bool is_color = keys[i]->kind == RT_KEY_COLOR;
        if (is_color && color == keys.size()) color = i;
        places.push_back(is_color ? color : i);
    }
    std::vector<Edit> further;
    std::string numbers = kind->id;
    // The numbers before the first word follow the kind; other keys are edits of their own.
    const size_t listed = static_cast<size_t>(
        std::find_if(keys.begin(), keys.end(), [](const rt_key* key) { return is_word(*key); }) - keys.begin());
    while (!s.done()) {
        const size_t i = s.key();
        values[places[i]] = read_look(s, *keys[i]);
        if (i >= listed) further.push_back({key + "." + keys[i]->name, look_text(*keys[i], values[i]), s.position()});
    }
    for (size_t i = 0; i < listed; ++i)
        if (places[i] == i) numbers += "," + text_of(values[i].data(), count_of(*keys[i]));
    document.edits.push_back({key, numbers, s.position()});
    document.edits.insert(document.edits.end(), further.begin(), further.end());
}

}  // namespace scene_format
