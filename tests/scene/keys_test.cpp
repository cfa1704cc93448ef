// The tables of lights and materials: every key is stored, read back, written as text and moved as its row says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/numbers.hpp"
#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "scene/sky_kinds.hpp"

namespace clarity {
namespace {

// A value other than the default that each key takes.
std::array<float, 3> another(const Key& key) {
    if (key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG) return {key.def[0] == 0 ? 1.0f : 0.0f, 0, 0};
    if (key.kind == RT_KEY_VECTOR) return {0.6f, 0.8f, 0};
    std::array<float, 3> value{};
    for (size_t k = 0; k < count_of(key); ++k) value[k] = 0.125f + 0.25f * static_cast<float>(k);
    return value;
}

template <class Struct>
void expect_kept(const std::vector<Key>& keys, const Struct& start) {
    for (const Key& key : keys) {
        SCOPED_TRACE(key.name);
        Struct changed = start;
        EXPECT_EQ(value_of(key, &start), key.def);
        EXPECT_EQ(range_fault(key, key.def), "");
        const std::array<float, 3> value = another(key);
        set_value(key, &changed, value);
        EXPECT_EQ(value_of(key, &changed), value);
        for (const Key& other : keys)
            if (other.offset != key.offset || other.bit != key.bit) {
                EXPECT_EQ(value_of(other, &changed), other.def) << other.name << " shares its place";
            }
        std::array<float, 3> read{};
        std::string expected;
        EXPECT_TRUE(read_value(key, value_text(key, value, ","), read, expected)) << expected;
        EXPECT_EQ(read, value);
    }
}

TEST(Keys, OfMaterialsAreKeptAndReadBack) {
    expect_kept(material_keys(), default_material());
}

TEST(Keys, OfLightsAreKeptAndReadBack) {
    for (const LightKind& kind : light_kinds()) {
        SCOPED_TRACE(kind.name);
        rt_light light{};
        light.kind = kind.kind;
        for (const Key& key : kind.keys) set_value(key, &light, key.def);
        expect_kept(kind.keys, light);
        EXPECT_EQ(find_light_kind(kind.name), &kind);
        EXPECT_EQ(light_fault(default_light(kind.kind)), "");
    }
    EXPECT_EQ(light_kinds().size(), RT_LIGHT_KINDS);
}

TEST(Keys, RefuseWhatIsOutsideOfTheirRange) {
    std::array<float, 3> value{};
    std::string expected;
    EXPECT_FALSE(read_value(material_key("shininess"), "1000001", value, expected));
    EXPECT_EQ(expected, "from 0 to 1e+06");
    EXPECT_FALSE(read_value(material_key("model"), "wood", value, expected));
    EXPECT_NE(expected.find("conductor"), std::string::npos);
    rt_material m = default_material();
    m.roughness = 1.5f;
    EXPECT_EQ(material_fault(m), "`roughness` is 1.5, expected from 0 to 1");
    rt_light light = default_light(RT_LIGHT_DISC);
    light.radius = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(light_fault(light).text().find("radius"), std::string::npos);
    EXPECT_EQ(nearest_value(material_key("ior"), {0, 0, 0})[0], 1.5f) << "files write 0 for what they do not say";
    EXPECT_EQ(nearest_value(material_key("reflect"), {7, 0, 0})[0], 1);
}

// The least and the greatest number that a message names are taken, as text and in a struct, and nothing beyond them.
TEST(Keys, HaveTheLimitsThatMessagesName) {
    std::vector<const std::vector<Key>*> tables = {&material_keys()};
    for (const LightKind& kind : light_kinds()) tables.push_back(&kind.keys);
    for (const SkyKind& kind : sky_kinds()) tables.push_back(&kind.keys);
    for (const std::vector<Key>* table : tables)
        for (const Key& key : *table) {
            if (key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG) continue;
            SCOPED_TRACE(key.name);
            const auto answer = [&](const std::string& one) {
                std::string text = one, expected;
                for (size_t k = 1; k < count_of(key); ++k) text += "," + one;
                std::array<float, 3> value{};
                return read_value(key, text, value, expected) ? "" : expected;
            };
            const std::string least = exact_text(key.min), most = exact_text(key.max);
            if (key.kind != RT_KEY_VECTOR || key.min != 0) {
                EXPECT_EQ(answer(least), "");
            }
            EXPECT_EQ(answer(most), "");
            const std::string range = "from " + least + " to " + most;
            EXPECT_EQ(answer(exact_text(std::nextafter(static_cast<float>(key.min), -INFINITY))), range);
            EXPECT_EQ(answer(exact_text(std::nextafter(static_cast<float>(key.max), INFINITY))), range);
            EXPECT_EQ(answer(exact_text(key.max + std::fabs(key.max))), key.max == 0 ? "" : range);
        }
}

TEST(Keys, ATransformMovesEachLightAsItsKeysSay) {
    // Twice as large, turned a quarter about z, then moved.
    const Matrix m = {0, -2, 0, 10, 2, 0, 0, 20, 0, 0, 2, 30};
    for (const LightKind& kind : light_kinds()) {
        SCOPED_TRACE(kind.name);
        rt_light light = default_light(kind.kind);
        ASSERT_TRUE(move_light(light, m));
        if (kind.has_place) {
            EXPECT_EQ(light.position[0], -10) << "0 10 0, twice as far, turned";
            EXPECT_EQ(light.position[2], 30);
        } else {
            EXPECT_EQ(light.position[0], -1) << "towards the light: 0 1 0 turned, and of length 1";
        }
        if (kind.kind == RT_LIGHT_RECT) {
            EXPECT_EQ(light.u[1], 2);
            EXPECT_EQ(light.v[2], 2);
            EXPECT_FLOAT_EQ(light.area, 16);
            EXPECT_FLOAT_EQ(light.normal[0], 1) << "u x v";
        }
        if (kind.kind == RT_LIGHT_SPHERE) {
            EXPECT_FLOAT_EQ(light.radius, 2);
        }
        if (kind.kind == RT_LIGHT_SPOT) {
            EXPECT_FLOAT_EQ(light.normal[0], 1);
        }
    }
}

TEST(Keys, WhatImportersDeliverIsBroughtIntoRangeOrRefused) {
    rt_light_desc desc{};
    desc.struct_bytes = sizeof desc;
    desc.kind = RT_LIGHT_SPOT;
    desc.position[0] = 3, desc.direction[2] = -2, desc.color[1] = 4, desc.color[2] = -1;
    const rt_key_value values[] = {{"angle", {500, 0, 0}, 0}, {"falloff", {1, 0, 0}, 0}, {"of_tomorrow", {1, 0, 0}, 0}};
    desc.values = values, desc.value_count = 3;
    rt_light light{};
    std::string problem;
    ASSERT_TRUE(light_of(desc, light, problem));
    EXPECT_NE(problem.find("does not know"), std::string::npos);
    ASSERT_TRUE(make_sound(light));
    EXPECT_EQ(light_fault(light), "");
    EXPECT_EQ(light.position[0], 3);
    EXPECT_EQ(light.normal[2], -1);
    EXPECT_EQ(light.color[1], 4);
    EXPECT_EQ(light.color[2], 0);
    EXPECT_EQ(light.angle, 180);
    EXPECT_EQ(light.flags, RT_LIGHT_FALLOFF);
    desc.position[1] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(light_of(desc, light, problem));
}

TEST(Keys, ALightWithoutSizeIsRefused) {
    rt_light light = default_light(RT_LIGHT_RECT);
    std::copy_n(light.u, 3, light.v);
    EXPECT_FALSE(make_sound(light));
}

TEST(Keys, SharesFollowTheModelUntilTheyAreSet) {
    MaterialValues m = default_material();
    const auto set = [&](const char* key, float x) { set_material_value(m, material_key(key), {x, x, x}); };
    set("roughness", 0.5f);
    EXPECT_EQ(m.reflect, 0) << "Whitted's own mixture stays";
    set("model", RT_MODEL_CONDUCTOR);
    EXPECT_EQ(m.reflect, 0.5f);
    set("roughness", 0.25f);
    EXPECT_EQ(m.reflect, 0.75f);
    set("color", 0.5f);
    EXPECT_EQ(m.specular[0], 0.5f);
    set("reflect", 0.25f);
    set("roughness", 0);
    EXPECT_EQ(m.reflect, 0.25f);
    set("model", RT_MODEL_LAMBERT);
    EXPECT_EQ(m.reflect, 0);
    EXPECT_EQ(m.specular[1], 0);
    set("model", RT_MODEL_GLTF);
    EXPECT_EQ(m.reflect, 0) << "no metal";
    set("metallic", 1);
    set("roughness", 0.25f);
    EXPECT_EQ(m.reflect, 0.75f);
    set("transmission", 0.5f);
    EXPECT_EQ(m.refract, 0.5f);
    EXPECT_EQ(m.reflect, 0.5f) << "no more than is left";
}

TEST(Keys, LayersFollowThePlainValues) {
    MaterialValues m = default_material();
    EXPECT_EQ(m.layers.specular_weight, 1);
    EXPECT_EQ(m.layers.iridescence_thickness, 400);
    EXPECT_EQ(m.layers.flags, 0u) << "thin";
    EXPECT_EQ(MaterialValues(rt_material{}).layers.iridescence_ior, 1.3f);
    set_material_value(m, material_key("clearcoat"), {0.5f, 0, 0});
    set_material_value(m, material_key("thin"), {0, 0, 0});
    EXPECT_EQ(m.layers.clearcoat, 0.5f);
    EXPECT_EQ(m.layers.flags, RT_LAYERS_SOLID);
    m.layers.sheen_roughness = 2;
    EXPECT_EQ(material_fault(m), "`sheen_roughness` is 2, expected from 0 to 1");
    EXPECT_TRUE(has_key(RT_MODEL_GLTF, material_key("metallic")) && has_key(RT_MODEL_LAMBERT, material_key("color")));
    EXPECT_FALSE(has_key(RT_MODEL_LAMBERT, material_key("metallic")));
}

// // The tables of lights, skies, materials and their textures in docs/scene_format.md are those of the program.
// CLARITY_WRITE_PAGES=1 writes them.

constexpr const char* kPage = CLARITY_SOURCE_DIR "/docs/scene_format.md";

std::string words_of(const Key& key) {
    std::string words;
    for (size_t i = 0; key.words && key.words[i]; ++i) words += (i ? ", `" : "`") + std::string(key.words[i]) + "`";
    return words;
}

// "`color r g b`", the default, and what it means, with its range.
std::string row(const Key& key, const std::string& first) {
    std::string help = key.help, argument = "f";
    if (count_of(key) == 3) {
        argument = key.kind == RT_KEY_COLOR ? "r g b" : "x y z";
        help = help.substr(std::min(help.size(), argument.size()));
        if (help.rfind(", ", 0) == 0) help = help.substr(2);
    }
    if (key.kind == RT_KEY_WORD) argument = "WORD";
    std::string meaning = key.kind == RT_KEY_WORD ? words_of(key) + ": " + help : help;
    if (*key.more) meaning += (meaning.empty() ? "" : "; ") + std::string(key.more);
    const bool is_number = key.kind != RT_KEY_WORD && key.kind != RT_KEY_FLAG;
    if (is_number && key.max < kMostNumber) meaning += "; " + exact_text(key.min) + " to " + exact_text(key.max);
    const std::string name = std::string(key.name) + (key.kind == RT_KEY_FLAG ? "" : " " + argument);
    const bool is_grey = key.kind == RT_KEY_COLOR && key.def[0] == key.def[1] && key.def[1] == key.def[2];
    const std::string def = is_grey ? exact_text(key.def[0]) : value_text(key, key.def, " ");
    return "|" + first + " `" + name + "` | `" + def + "` | " + meaning + " |\n";
}

std::string material_table() {
    std::string table = "| key | default | meaning |\n|---|---|---|\n";
    for (const Key& key : material_keys()) table += row(key, "");
    return table;
}

// The kinds of lights or skies, with their keys.
template <class Kind>
std::string kind_table(const char* what, const std::vector<Kind>& kinds) {
    std::string table = "| " + std::string(what) + " | key | default | meaning |\n|---|---|---|---|\n";
    for (const Kind& kind : kinds) {
        std::string first = " **" + std::string(kind.name) + "**, " + kind.help + " |";
        for (const Key& key : kind.keys) {
            table += row(key, first);
            first = " |";
        }
    }
    return table;
}

void expect_in_page(const std::string& name, const std::string& table) {
    std::ifstream in(kPage);
    std::string page{std::istreambuf_iterator<char>(in), {}};
    const std::string begin = "<!-- " + name + " -->\n", end = "<!-- end -->";
    const size_t from = page.find(begin), to = page.find(end, from);
    ASSERT_NE(to, std::string::npos) << kPage << " has no table between " << begin << " and " << end;
    const size_t first = from + begin.size();
    if (std::getenv("CLARITY_WRITE_PAGES")) {
        page.replace(first, to - first, table);
        std::ofstream(kPage) << page;
        return;
    }
    EXPECT_EQ(page.substr(first, to - first), table) << "run this test with CLARITY_WRITE_PAGES=1 and look at the page";
}

TEST(KeysPage, HasTheLights) {
    expect_in_page("lights", kind_table("light", light_kinds()));
}

TEST(KeysPage, HasTheSky) {
    expect_in_page("sky", kind_table("sky", sky_kinds()));
}

TEST(KeysPage, HasTheMaterial) {
    expect_in_page("material", material_table());
}

TEST(KeysPage, HasTheMaps) {
    std::string table = "| key | space | multiplies | channels |\n|---|---|---|---|\n";
    for (const MapUse& use : map_uses()) {
        std::string keys;
        for (const char* const* key = use.multiplies.data(); *key; ++key)
            keys += (keys.empty() ? "`" : ", `") + std::string(*key) + "`";
        table += "| `" + std::string(use.name) + " NAME` | `" + (use.space == RT_SPACE_SRGB ? "srgb" : "linear") + "` | " +
                 keys + " | " + use.help + " |\n";
    }
    expect_in_page("maps", table);
}

// A key that a texture multiplies exists, and reaches 1.
TEST(MapUses, MultiplyKeysOfMaterials) {
    for (const MapUse& use : map_uses())
        for (const char* const* name = use.multiplies.data(); *name; ++name) {
            const Key* key = find_key(material_keys(), *name);
            ASSERT_TRUE(key) << *name;
            EXPECT_TRUE(key->min <= 1 && key->max >= 1) << *name;
        }
}

}  // namespace
}  // namespace clarity
