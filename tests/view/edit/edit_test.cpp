// Edits of a view as text: each is restored exactly, and wrong ones are refused with what is allowed.
#include "view/edit/edit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "scene/light_kinds.hpp"
#include "scene/material_keys.hpp"
#include "scene/sky_kinds.hpp"
#include "support/generated.hpp"
#include "view/edit/sky_edit.hpp"

namespace clarity::test {
namespace {

Scene two_boxes() {
    Scene scene = scene_of(box(1));
    scene.instances.push_back(scene.instances.front());
    scene.instances.push_back(scene.instances.front());
    add_material(scene, mirror(0.5f));
    return scene;
}

EditedView first_view(const Scene& scene) {
    return {make_view(scene, 4.0f / 3.0f), {}, {}};
}

EditedView replay(const Scene& scene, const std::vector<Word>& words) {
    EditedView edited = first_view(scene);
    for (const Word& word : words) apply_edit(scene, edited, word.key, word.value);
    return edited;
}

bool same_lights(const std::vector<rt_light>& a, const std::vector<rt_light>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(rt_light)) == 0;
}

TEST(Edit, EveryChangeIsRestoredBitByBit) {
    const Scene scene = two_boxes();
    EditedView edited = first_view(scene);
    View& view = edited.view;
    view.camera.eye = {0.1f, -1.0f / 3.0f, 12345.678f};
    view.camera.target = {1e-7f, 2, 3};
    view.camera.up = {0.01f, 0.99f, 0};
    view.background = {0.1f, 0.2f, 1.0f / 3.0f};
    view.ambient = {0, 0, 0};
    view.lights[0].position[1] = 7.7f;
    view.lights[0].flags &= ~RT_LIGHT_STAND_IN;  // as whatever sets a light does
    view.lights.push_back(whitted_light(RT_LIGHT_DIRECTIONAL, {0, 0.6f, 0.8f}, {1, 2, 3}));
    edited.lights_on = {true, false, true};
    for (const Material& material : scene.materials) view.materials.push_back(material.values);
    view.materials[1].ior = 1.33f;
    view.materials[1].color[2] = 0.123456789f;
    edited.instances.hidden = {0, 2};
    edited.instances.set_shift(1, {{1, 2, 0.1f}, {0, 90, 0}, {2, 2, 0.3f}});
    edited.instances.set_mask(1, RT_SEEN_BY_SHADOW);
    // The float in radians is restored, whatever angle it was made from.
    for (const float fov : {0.7853982f, 0.1f, 1.234567f, 3.0f, 0.9999999f}) {
        view.camera.fov_y_rad = fov;
        const EditedView again = replay(scene, edits_between(scene, first_view(scene), edited));
        EXPECT_EQ(again.view.camera.eye, view.camera.eye);
        EXPECT_EQ(again.view.camera.target, view.camera.target);
        EXPECT_EQ(again.view.camera.up, view.camera.up);
        EXPECT_EQ(again.view.camera.fov_y_rad, fov);
        EXPECT_EQ(again.view.background, view.background);
        EXPECT_EQ(again.view.ambient, view.ambient);
        EXPECT_TRUE(same_lights(again.view.lights, view.lights));
        EXPECT_TRUE(same_lights(visible_view(again).lights, visible_view(edited).lights));
        EXPECT_TRUE(again.instances == edited.instances);
        ASSERT_EQ(again.view.materials.size(), view.materials.size());
        EXPECT_EQ(
            std::memcmp(again.view.materials.data(), view.materials.data(), view.materials.size() * sizeof(MaterialValues)), 0);
    }
}

TEST(Edit, LightsAndModelsOfAllKindsAreRestoredBitByBit) {
    const Scene scene = two_boxes();
    EditedView edited = first_view(scene);
    View& view = edited.view;
    for (const Material& material : scene.materials) view.materials.push_back(material.values);
    view.camera.aperture = 0.1f;
    view.camera.focus = 1.0f / 3.0f;
    for (const LightKind& kind : light_kinds()) {
        rt_light light = default_light(kind.kind);
        for (const Key& key : kind.keys)
            if (key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG || key.kind == RT_KEY_NUMBER)
                set_value(key, &light, {1, 0, 0});
        ASSERT_TRUE(make_sound(light));
        view.lights.push_back(light);
    }
    MaterialValues& metal = view.materials[1];
    set_material_value(metal, material_key("model"), {RT_MODEL_CONDUCTOR, 0, 0});
    set_material_value(metal, material_key("roughness"), {0.3f, 0, 0});
    set_material_value(metal, material_key("reflect"), {scene.materials[1].values.reflect, 0, 0});  // as before: must be kept
    set_material_value(metal, material_key("compensate"), {0, 0, 0});
    set_material_value(metal, material_key("absorption"), {0.1f, 0.2f, 1.0f / 3.0f});
    MaterialValues& layered = view.materials[0];
    set_material_value(layered, material_key("model"), {RT_MODEL_GLTF, 0, 0});
    set_material_value(layered, material_key("metallic"), {0.4f, 0, 0});
    set_material_value(layered, material_key("thin"), {0, 0, 0});
    set_material_value(layered, material_key("sheen_color"), {0.1f, 0.2f, 1.0f / 3.0f});
    const EditedView again = replay(scene, edits_between(scene, first_view(scene), edited));
    EXPECT_TRUE(same_lights(again.view.lights, view.lights));
    ASSERT_EQ(again.view.materials.size(), view.materials.size());
    EXPECT_EQ(std::memcmp(again.view.materials.data(), view.materials.data(), view.materials.size() * sizeof(rt_material)), 0);
    EXPECT_EQ(again.view.camera.aperture, 0.1f);
    EXPECT_EQ(again.view.camera.focus, view.camera.focus);
}

TEST(Edit, EverySkyIsRestored) {
    Scene scene = two_boxes();
    scene.sky.values.kind = RT_SKY_PICTURE;
    for (const SkyKind& kind : sky_kinds()) {
        EditedView edited = first_view(scene);
        SkyValues sky;
        sky.kind = kind.kind;
        float number = 0.1f;
        for (const Key& key : kind.keys) {
            if (key.alias) continue;
            set_value(key, &sky,
                      key.kind == RT_KEY_FLAG ? std::array<float, 3>{} : std::array<float, 3>{number, number * 2, 1.0f / 3.0f});
            number += 0.1f;
        }
        edited.view.sky = sky;
        const EditedView again = replay(scene, edits_between(scene, first_view(scene), edited));
        EXPECT_TRUE(same_sky(sky_of(scene, again.view), sky)) << kind.name;
        EXPECT_EQ(edits_between(scene, again, edited).size(), 1u) << "the camera alone";
    }
}

TEST(Edit, AnotherKindOfSkyKeepsItsColour) {
    const Scene scene = two_boxes();
    EditedView edited = first_view(scene);
    SkyValues sky = sky_of(scene, edited.view);
    choose_sky_kind(scene, edited.view, RT_SKY_CONSTANT, sky);
    EXPECT_EQ(sky.kind, RT_SKY_CONSTANT);
    EXPECT_EQ(sky.color[1], edited.view.background[1]);
    choose_sky_kind(scene, edited.view, RT_SKY_GRADIENT, sky);
    EXPECT_EQ(sky.ground[1], sky.color[1]);
    choose_sky_kind(scene, edited.view, RT_SKY_PICTURE, sky);
    EXPECT_EQ(sky.kind, RT_SKY_GRADIENT) << "there is no picture";
}

TEST(Edit, OneKeyOfALight) {
    const Scene scene = two_boxes();
    EditedView edited = first_view(scene);
    apply_edit(scene, edited, "light.2", "disc");
    apply_edit(scene, edited, "light.2.radius", "3");
    apply_edit(scene, edited, "light.2.two_sided", "true");
    apply_edit(scene, edited, "light.0.falloff", "square");
    const std::vector<rt_light>& lights = edited.view.lights;
    ASSERT_EQ(lights.size(), 3u);
    EXPECT_EQ(lights[2].kind, RT_LIGHT_DISC);
    EXPECT_FLOAT_EQ(lights[2].area, 56.548668f) << "2 pi 3^2";
    EXPECT_EQ(lights[0].flags, RT_LIGHT_FALLOFF);
}

TEST(Edit, UnchangedValuesAreNotWritten) {
    const Scene scene = two_boxes();
    const EditedView edited = first_view(scene);
    const std::vector<Word> words = edits_between(scene, edited, edited);
    ASSERT_EQ(words.size(), 1u);
    EXPECT_EQ(words[0].key, "camera");
}

TEST(Edit, RemovedLightsAreOff) {
    const Scene scene = two_boxes();
    EditedView edited = first_view(scene);
    ASSERT_EQ(edited.view.lights.size(), 2u);
    edited.view.lights.pop_back();
    const EditedView again = replay(scene, edits_between(scene, first_view(scene), edited));
    EXPECT_TRUE(same_lights(visible_view(again).lights, edited.view.lights));
}

TEST(Edit, HidingInstancesKeepsTheNumbersOfTheOthers) {
    const Scene scene = two_boxes();
    Progress progress;
    const BuildScene all = make_build_scene(scene, progress);
    const BuildScene some = make_build_scene(with_edits(scene, {{}, {1}}), progress);
    ASSERT_EQ(all.instances.size(), 3u);
    ASSERT_EQ(some.instances.size(), 2u);
    EXPECT_EQ(some.instances[1].first_prim, all.instances[2].first_prim);
    EXPECT_EQ(place_of_prim(scene, static_cast<rt_i32>(all.instances[2].first_prim)).instance, 2u);
}

TEST(Edit, HidingEverythingLeavesTheSky) {
    const Scene scene = two_boxes();
    const auto nothing = shared_scene(with_edits(scene, {{}, {0, 1, 2}}));
    const FloatImage t =
        Workbench::get().values(nothing, make_settings({{"aov", "t"}, {"size", "16x12"}}), first_view(scene).view);
    for (const float value : t.pixels) EXPECT_TRUE(std::isinf(value));
}

TEST(Edit, RefusalsNameTheAllowedValues) {
    const Scene scene = two_boxes();
    const std::vector<std::array<std::string, 3>> wrong = {
        {"camera", "1,2,3", "ex,ey,ez"},
        {"camera", "0,0,5,0,0,0,180,0,1,0", "between 0 and 180"},
        {"camera", "0,0,5,0,0,nan,45,0,1,0", "ex,ey,ez"},
        {"background", "1,2", "r,g,b"},
        {"background", "-1,0,0", "negative"},
        {"light.9", "off", "2 lights"},
        {"light.2", "off", "no such light"},
        {"light.x", "off", "counts from 0"},
        {"light.0", "beam,1,2,3,1,1,1", "point,x,y,z"},
        {"light.0", "spot,1,2,3,1,1,1", "11 numbers"},
        {"light.0.radius", "1", "position, color, falloff, range"},
        {"light.2.color", "1,1,1", "2 lights"},
        {"light.0", "rect,0,1,0,1,0,0,1,0,0,1,1,1", "has a size"},
        {"material.0.model", "wood", "conductor"},
        {"camera.aperture", "-1", "a length from 0 to 1e15"},
        {"camera.focus", "2e15", "a length from 0 to 1e15"},
        {"light.0", "point,1,2", "six numbers"},
        {"light.0", "directional,0,0,0,1,1,1", "no length"},
        {"light.0", "point,0,0,0,-1,0,0", "from 0 to 1e+15"},
        {"material.7.color", "1,1,1", "0 to 1"},
        {"material.0.colour", "1,1,1", "shininess"},
        {"material.0", "1", "material.N.PART"},
        {"material.0.reflect", "1.5", "from 0 to 1"},
        {"material.0.ior", "0", "from 0.001"},
        {"hide", "3", "3 instances"},
        {"hide", "2-1", "3,5-9"},
        {"hide", "a", "3,5-9"},
        {"hide", "0-4294967295", "3 instances"},
        {"lights.0", "off", "no edit"},
    };
    for (const auto& [key, value, says] : wrong) {
        EditedView edited = first_view(scene);
        try {
            apply_edit(scene, edited, key, value);
            ADD_FAILURE() << key << "=" << value << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::usage);
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << key << "=" << value << ": " << error.what();
        }
    }
}

TEST(PlaceOfPrim, NumbersPrimitivesAsTheAovsDo) {
    Scene scene = two_boxes();
    scene.instances[1].material = 1;
    scene.spheres.push_back({{0, 5, 0}, 1, 1});
    scene.planes.push_back({{0, 1, 0}, 0, 0});
    const rt_u32 triangles = scene.triangle_count();
    const PrimPlace second = place_of_prim(scene, static_cast<rt_i32>(triangles + 3));
    EXPECT_EQ(second.instance, 1u);
    EXPECT_EQ(second.index, 3u);
    EXPECT_EQ(second.material, 1u);
    EXPECT_EQ(place_of_prim(scene, static_cast<rt_i32>(3 * triangles)).kind, PrimPlace::Kind::sphere);
    EXPECT_EQ(place_of_prim(scene, static_cast<rt_i32>(3 * triangles + 1)).kind, PrimPlace::Kind::plane);
    EXPECT_EQ(place_of_prim(scene, static_cast<rt_i32>(3 * triangles + 2)).kind, PrimPlace::Kind::none);
    EXPECT_EQ(place_of_prim(scene, -1).kind, PrimPlace::Kind::none);
}

}  // namespace
}  // namespace clarity::test
