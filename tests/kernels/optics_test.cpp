// optics_test.cpp -- kernels that know only a view's lights and surfaces make the same picture, bit by bit, as those that know
// all; and no picture is made with kernels that know too little.
#include <gtest/gtest.h>

#include <cstring>

#include "kernels/scene_features.hpp"
#include "scene/light_kinds.hpp"
#include "support/generated.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

Scene room() {
    Scene scene = scene_of(box(0.6));
    scene.spheres.push_back({{1.2f, 0.2f, 1}, 0.5f, 0});
    scene.planes.push_back({{0, 1, 0}, -0.7f, add_material(scene, diffuse(0.6f, 0.6f, 0.5f))});
    return scene;
}

View seen(const std::vector<rt_light>& lights) {
    View view = view_from({0.5f, 1.5f, 6}, {0, 0, 0}, 45);
    view.background = {0, 0, 0};
    view.lights = lights;
    return view;
}

rt_light light(rt_u32 kind, rt_u32 flags = 0) {
    rt_light made = default_light(kind);
    if (light_kind_of(made).has_place) made.position[0] = 1, made.position[1] = 3, made.position[2] = 2;
    if (kind == RT_LIGHT_SUN) made.angle = 5;
    made.flags |= flags;
    make_sound(made);
    return made;
}

rt_material of_model(rt_u32 model, float roughness = 0, float absorption = 0) {
    rt_material m = diffuse(0.8f, 0.7f, 0.6f);
    m.model = model;
    m.roughness = roughness;
    m.ior = 1.4f;
    for (float& a : m.absorption) a = absorption;
    return m;
}

FloatImage picture(const ScenePtr& scene, const View& view, Settings settings, const Optics& optics) {
    settings.optics = optics;
    Progress progress;
    static Preparer preparer(bench().plugins(), bench().shared_device());
    bench().frames().trace(*preparer.prepare(scene, settings, progress), settings, view, 0, false, progress);
    return bench().frames().read_values();
}

Settings settings_of(const char* tracer) {
    return make_settings(
        {{"tracer", tracer}, {"size", "48x32"}, {"depth", "6"}, {"accel", "bvh2"}, {"lanes", "4"}, {"packet", "4x4"}});
}

size_t differing(const FloatImage& a, const FloatImage& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) count += std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(float)) != 0;
    return count;
}

double mean(const FloatImage& image) {
    double sum = 0;
    for (const float value : image.pixels) sum += value;
    return sum / double(image.pixels.size());
}

struct Case {
    const char* name;
    MaterialValues surface;
    std::vector<rt_light> lights;
    Optics expected;  // of the view alone, for `path`
    bool glows = false, sky = false;
};

// RT_MODEL_GLTF with one layer.
MaterialValues layered(void (*change)(rt_layers&)) {
    MaterialValues m = of_model(RT_MODEL_GLTF, 0.4f);
    change(m.layers);
    return m;
}

std::vector<Case> cases() {
    const auto bit = [](rt_u32 kind) { return 1u << kind; };
    const rt_material lambert = of_model(RT_MODEL_LAMBERT);
    rt_material mixed = glass(1.5f);
    mixed.reflect = 0.3f, mixed.refract = 0.3f;
    return {
        {"Lambert under a point", lambert, {light(RT_LIGHT_POINT)}, {bit(RT_LIGHT_POINT), 0}},
        {"a mixture under a fading spot",
         mixed,
         {light(RT_LIGHT_SPOT, RT_LIGHT_FALLOFF)},
         {bit(RT_LIGHT_SPOT) | RT_LIGHTS_FADE, RT_LOBE_MIRROR | RT_LOBE_GLASS}},
        {"metal under a rect and a disc",
         of_model(RT_MODEL_CONDUCTOR, 0.4f),
         {light(RT_LIGHT_RECT), light(RT_LIGHT_DISC)},
         {bit(RT_LIGHT_RECT) | bit(RT_LIGHT_DISC), RT_LOBE_METAL}},
        {"tinted glass under a sphere and the sky",
         of_model(RT_MODEL_DIELECTRIC, 0, 0.5f),
         {light(RT_LIGHT_SPHERE)},
         {bit(RT_LIGHT_SPHERE) | bit(RT_EMITTER_SKY), RT_LOBE_GLASS | RT_LOBE_ABSORBS},
         false,
         true},
        {"frosted glass, glowing, under a sun and a parallel light",
         of_model(RT_MODEL_DIELECTRIC, 0.5f),
         {light(RT_LIGHT_SUN), light(RT_LIGHT_DIRECTIONAL)},
         {bit(RT_LIGHT_SUN) | bit(RT_LIGHT_DIRECTIONAL) | bit(RT_EMITTER_SURFACE), RT_LOBE_GLASS | RT_LOBE_FROSTED},
         true},
        {"glTF's core",
         layered([](rt_layers& l) { l.metallic = 0.5f; }),
         {light(RT_LIGHT_POINT)},
         {bit(RT_LIGHT_POINT), RT_LOBE_LAYERS}},
        {"varnish and fibres",
         layered([](rt_layers& l) { l.clearcoat = 1, l.sheen_color[0] = 0.5f; }),
         {light(RT_LIGHT_SPHERE)},
         {bit(RT_LIGHT_SPHERE), RT_LOBE_LAYERS | RT_LOBE_COAT | RT_LOBE_SHEEN}},
        {"a sheet with a film",
         layered([](rt_layers& l) { l.transmission = 0.7f, l.iridescence = 1; }),
         {light(RT_LIGHT_SPHERE)},
         {bit(RT_LIGHT_SPHERE), RT_LOBE_LAYERS | RT_LOBE_THIN | RT_LOBE_FILM}},
        {"a solid",
         layered([](rt_layers& l) { l.transmission = 0.7f, l.flags = RT_LAYERS_SOLID; }),
         {light(RT_LIGHT_SPHERE)},
         {bit(RT_LIGHT_SPHERE), RT_LOBE_LAYERS | RT_LOBE_GLASS | RT_LOBE_FROSTED}},
        {"a solid that mirrors less",
         layered([](rt_layers& l) { l.transmission = 0.7f, l.flags = RT_LAYERS_SOLID, l.specular_weight = 0.5f; }),
         {light(RT_LIGHT_SPHERE)},
         {bit(RT_LIGHT_SPHERE), RT_LOBE_LAYERS | RT_LOBE_GLASS | RT_LOBE_FROSTED | RT_LOBE_CHANGED}},
        {"unlit", of_model(RT_MODEL_UNLIT), {light(RT_LIGHT_POINT)}, {bit(RT_LIGHT_POINT), RT_LOBE_UNLIT}},
    };
}

void expect_same_pictures(const char* tracer) {
    size_t number = 0;
    for (const Case& c : cases()) {
        if (number++ % 6 != 1 && quick()) continue;
        Scene made = room();
        made.materials[0].values = c.surface;
        if (c.glows) made.materials[0].values.emission[1] = 2;
        const ScenePtr scene = shared_scene(std::move(made));
        View view = seen(c.lights);
        if (c.sky) view.background = {0.2f, 0.3f, 0.4f};
        const Settings settings = settings_of(tracer);
        const Optics own = optics_of(*scene, view, settings);
        if (picture_of_tracer(tracer) == kPathPicture) {
            EXPECT_EQ(own.lights, c.expected.lights) << c.name;
            EXPECT_EQ(own.lobes, c.expected.lobes) << c.name;
        }
        const FloatImage little = picture(scene, view, settings, own),
                         all = picture(scene, view, settings, {RT_LIGHTS_ALL, RT_LOBES_ALL});
        EXPECT_GT(mean(all), 1e-3) << c.name;
        EXPECT_EQ(differing(little, all), 0u) << c.name << ", " << tracer;
    }
}

TEST(Optics, PathIsTheSameBitByBit) {
    expect_same_pictures("path");
}

TEST(Optics, WhittedIsTheSameBitByBit) {
    expect_same_pictures("iterative");
}

// A scene with a material on each kind of primitive, and three on none.
TEST(Optics, AMaterialThatNothingHasIsUnknown) {
    Scene scene = room();
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].material = add_material(scene, of_model(RT_MODEL_LAMBERT));
    scene.spheres[0].material = add_material(scene, of_model(RT_MODEL_DIELECTRIC, 0.5f));
    const size_t used = scene.materials.size();
    MaterialValues glowing = of_model(RT_MODEL_CONDUCTOR, 0.4f);
    glowing.emission[1] = 2;
    const rt_u32 metal = add_material(scene, glowing);
    add_material(scene, layered([](rt_layers& l) { l.clearcoat = 1; }));
    scene.materials.back().values.texture = 0;
    scene.materials.back().values.alpha = RT_ALPHA_BLEND;
    note_used_materials(scene);
    for (size_t i = 0; i < scene.materials.size(); ++i) EXPECT_EQ(scene.materials[i].used, i < used) << i;

    const View view = seen({light(RT_LIGHT_POINT)});
    const ScenePtr shared = shared_scene(Scene(scene));
    const Optics known = optics_of(*shared, view, settings_of("path"));
    EXPECT_EQ(known.lights, 1u << RT_LIGHT_POINT);
    EXPECT_EQ(known.lobes, rt_u32(RT_LOBE_GLASS | RT_LOBE_FROSTED));
    EXPECT_EQ(known.cutouts, 0u);
    EXPECT_FALSE(features_of(*shared, BuildScene()).textures);
    EXPECT_EQ(differing(picture(shared, view, settings_of("path"), known),
                        picture(shared, view, settings_of("path"), {RT_LIGHTS_ALL, RT_LOBES_ALL})),
              0u);
    scene.instances[1].visible = false;  // it may be shown
    scene.instances[1].material = metal;
    note_used_materials(scene);
    EXPECT_EQ(optics_of(*shared_scene(Scene(scene)), view, settings_of("path")).lobes,
              rt_u32(RT_LOBE_GLASS | RT_LOBE_FROSTED | RT_LOBE_METAL));
}

// A view's lights and surfaces that came by an edit.
TEST(Optics, KernelsThatKnowTooLittleAreRefused) {
    const ScenePtr scene = shared_scene(room());
    const Settings settings = settings_of("path");
    View view = seen({light(RT_LIGHT_POINT)});
    EXPECT_NO_THROW(picture(scene, view, settings, {}));
    view.materials.clear();
    for (const Material& material : scene->materials) view.materials.push_back(material.values);
    view.materials[0].model = RT_MODEL_CONDUCTOR;
    EXPECT_THROW(picture(scene, view, settings, {}), Error);
    view.materials.clear();
    view.lights = {light(RT_LIGHT_RECT)};
    EXPECT_THROW(picture(scene, view, settings, {}), Error);
    EXPECT_NO_THROW(picture(scene, view, settings, optics_of(*scene, view, settings)));
    EXPECT_THROW(picture(scene, view, settings_of("iterative"), {}), Error);
}

}  // namespace
