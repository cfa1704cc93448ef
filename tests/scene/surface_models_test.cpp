// Models of surfaces that plugins bring: keys, numbers, edits as text.
#include <gtest/gtest.h>

#include <cstring>

#include "scene/material_keys.hpp"
#include "scene/surface_models.hpp"

using namespace clarity;

namespace {

const rt_surface_key kKeys[] = {{"width", "Width", "degrees", "of the lobe", RT_KEY_NUMBER, 0, 0, 90, {30}},
                                {"tint", "Tint", nullptr, "of the lobe", RT_KEY_COLOR, 0, 0, 1, {1, 0.5, 0.25}}};
const rt_surface_key kTaken[] = {{"roughness", "Roughness", nullptr, "of the lobe", RT_KEY_NUMBER, 0, 0, 1, {0.5}}};

rt_plugin plugin_of(const char* id) {
    rt_plugin plugin{};
    plugin.id = id;
    return plugin;
}

TEST(SurfaceModels, KeysBelongToTheirModel) {
    static const rt_plugin plugin = plugin_of("velvet"), other = plugin_of("other");
    const MaterialValues before = default_material();
    ASSERT_FALSE(add_surface_model(plugin, {sizeof(rt_surface), 2, kKeys, {"velvet.cl", "x"}}));
    const MaterialValues m0 = default_material();
    EXPECT_EQ(std::memcmp(&before, &m0, sizeof before), 0) << "others are as they were";
    const Key* const width = find_material_key(RT_MODEL_KINDS, "width");
    ASSERT_TRUE(width);
    EXPECT_TRUE(has_key(RT_MODEL_KINDS, *width));
    EXPECT_FALSE(has_key(RT_MODEL_GLTF, *width));
    MaterialValues m = default_material();
    set_material_value(m, *width, {45, 0, 0});
    EXPECT_EQ(std::memcmp(&m, &before, sizeof m), 0) << "another model has no room for it";
    std::array<float, 3> model{};
    std::string expected;
    ASSERT_TRUE(read_value(material_key("model"), "velvet", model, expected)) << expected;
    set_material_value(m, material_key("model"), model);
    EXPECT_EQ(value_of(*width, &m)[0], 30);
    EXPECT_EQ(value_of(*find_material_key(m.model, "tint"), &m)[2], 0.25f);
    set_material_value(m, material_key("clearcoat"), {1, 0, 0});
    EXPECT_EQ(value_of(*width, &m)[0], 30) << "layers of glTF lie in the same place";
    EXPECT_FALSE(material_fault(m));
    set_value(*width, &m, {91, 0, 0});
    EXPECT_EQ(material_fault(m), "`width` is 91, expected from 0 to 90");
    set_material_value(m, material_key("model"), {RT_MODEL_LAMBERT, 0, 0});
    EXPECT_EQ(value_of(material_key("iridescence_thickness"), &m)[0], 400) << "layers are those of the default again";
    const Problem taken = add_surface_model(other, {sizeof(rt_surface), 1, kTaken, {"other.cl", "x"}});
    EXPECT_NE(taken.text().find("'roughness' is one of all materials"), std::string::npos) << taken.text();
    EXPECT_TRUE(add_surface_model(plugin, {sizeof(rt_surface), 1, kKeys, {"velvet.cl", "x"}})) << "its keys have changed";
    EXPECT_THROW(number_surface_models({"other"}), std::logic_error) << "it would get another number than it has elsewhere";
}

}  // namespace
