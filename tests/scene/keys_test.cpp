// The tables of lights and materials: every key is stored, read back, written as text and moved as its row says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "scene/light_kinds.hpp"
#include "scene/material_keys.hpp"

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

}  // namespace
}  // namespace clarity
