// The result of each statement, its defaults, and how names and transforms work: see docs/scene_format.md.
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

#include "recorder.hpp"

namespace {

std::array<float, 3> transformed(const std::array<float, 12>& m, const std::array<float, 3>& p) {
    std::array<float, 3> q{};
    for (size_t row = 0; row < 3; ++row)
        q[row] = m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
    return q;
}

void expect_near(const std::array<float, 3>& actual, const std::array<float, 3>& expected) {
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], 1e-5) << "component " << i;
}

void expect_near(const float (&actual)[3], const std::array<float, 3>& expected) {
    expect_near(std::array<float, 3>{actual[0], actual[1], actual[2]}, expected);
}

Recording import_good(const std::string& text) {
    Recording r = import_text(text);
    EXPECT_EQ(r.status, RT_OK) << r.why;
    EXPECT_EQ(r.unsound(), "");
    return r;
}

TEST(SceneFormat, SkyOfThreeKinds) {
    EXPECT_TRUE(import_good("sphere").skies.empty());
    const Recording picture = import_good("sky \"a room.hdr\" strength 3 visible false rotate -90");
    ASSERT_EQ(picture.skies.size(), 1u);
    EXPECT_EQ(picture.sky_path, "a room.hdr");
    EXPECT_EQ(picture.skies[0].kind, RT_SKY_PICTURE);
    EXPECT_EQ(picture.skies[0].strength, 3);
    EXPECT_EQ(picture.skies[0].rotate_deg, -90);
    EXPECT_EQ(picture.skies[0].hidden, 1u);
    expect_near(picture.skies[0].color, {1, 1, 1});
    const Recording constant = import_good("sky constant .5 .7 1e3");
    ASSERT_EQ(constant.skies.size(), 1u);
    EXPECT_EQ(constant.sky_path, "");
    EXPECT_EQ(constant.skies[0].kind, RT_SKY_CONSTANT);
    EXPECT_EQ(constant.skies[0].strength, 1);
    EXPECT_EQ(constant.skies[0].hidden, 0u);
    expect_near(constant.skies[0].color, {.5f, .7f, 1e3f});
    const Recording gradient = import_good("sky gradient ground .1 horizon 1 2 3 zenith 4 5 6 visible true");
    ASSERT_EQ(gradient.skies.size(), 1u);
    EXPECT_EQ(gradient.skies[0].kind, RT_SKY_GRADIENT);
    expect_near(gradient.skies[0].color, {4, 5, 6});
    expect_near(gradient.skies[0].horizon, {1, 2, 3});
    expect_near(gradient.skies[0].ground, {.1f, .1f, .1f});
}

TEST(SceneFormat, ReadsTheExampleOfTheDesign) {
    const Recording r = import_good(R"(
camera   main  eye 0 2 8  target 0 1 0  up 0 1 0  fov 45
light    point  position 5 10 5  color 1 1 1
background 0.2 0.3 0.5
material glass  color .9 1 1  reflect .1  refract .9  ior 1.5
sphere   center 0 1 0  radius 1  material glass
plane    normal 0 1 0  offset 0  material floor
polygon  material mirror  vertices  0 0 0  2 0 0  2 2 0  0 2 0
load     "car.fbx"  translate 1 0 0  rotate 0 1 0 45  scale .01  material chrome  name car
material floor   # defined below its use
material mirror
material chrome
animate  car  translate  0 0 0 0   2 1 0 0        # time x y z ...
)");
    ASSERT_EQ(r.cameras.size(), 1u);
    EXPECT_EQ(r.cameras[0].name, "main");
    expect_near(r.cameras[0].values.eye, {0, 2, 8});
    expect_near(r.cameras[0].values.target, {0, 1, 0});
    EXPECT_NEAR(r.cameras[0].values.fov_y_rad, std::acos(-1.0) / 4, 1e-6);
    ASSERT_EQ(r.lights.size(), 1u);
    EXPECT_EQ(r.lights[0].values.kind, RT_LIGHT_POINT);
    expect_near(r.lights[0].values.position, {5, 10, 5});
    EXPECT_TRUE(r.has_background);
    EXPECT_FALSE(r.has_ambient);
    expect_near(r.background, {0.2f, 0.3f, 0.5f});
    ASSERT_EQ(r.materials.size(), 4u);
    EXPECT_EQ(r.materials[0].name, "glass");
    EXPECT_FLOAT_EQ(r.materials[0].values.refract, 0.9f);
    EXPECT_EQ(r.spheres.at(0).material, 0u);
    EXPECT_EQ(r.planes.at(0).material, 1u);
    EXPECT_EQ(r.polygons.at(0).material, 2u);
    EXPECT_EQ(r.polygons.at(0).corners.size(), 12u);
    ASSERT_EQ(r.loads.size(), 1u);
    EXPECT_EQ(r.loads[0].path, "car.fbx");
    EXPECT_EQ(r.loads[0].name, "car");
    EXPECT_EQ(r.loads[0].material, 3u);
    EXPECT_TRUE(r.warnings.empty());
    // `animate` hangs the loaded file on a node, which has its placement.
    ASSERT_EQ(r.nodes.size(), 1u);
    EXPECT_EQ(r.loads[0].node, 1u);
    expect_near(transformed(r.loads[0].world_from_object, {0, 0, 1}), {0, 0, 1});
    EXPECT_NEAR(r.nodes[0].translation[0], 1, 1e-6);
    EXPECT_NEAR(r.nodes[0].rotation[1], std::sin(3.14159265 / 8), 1e-6);
    EXPECT_NEAR(r.nodes[0].scale[0], 0.01, 1e-6);
    ASSERT_EQ(r.clips.size(), 1u);
    EXPECT_EQ(r.clips[0].end_s, 2);
    ASSERT_EQ(r.channels.size(), 3u);
    EXPECT_EQ(r.channels[0].moves, rt_u32(RT_MOVES_TRANSLATION));
    EXPECT_EQ(r.channels[0].component, 0u);
    EXPECT_EQ(r.channels[0].values, (std::vector<double>{0, 1}));
}

TEST(SceneFormat, PlacesLoadedFiles) {
    const Recording r = import_good("load car.fbx translate 1 0 0  rotate 0 1 0 45  scale .01\n");
    expect_near(transformed(r.loads.at(0).world_from_object, {0, 0, 0}), {1, 0, 0});
    const float leg = 0.01f * std::sqrt(0.5f);
    expect_near(transformed(r.loads[0].world_from_object, {0, 0, 1}), {1 + leg, 0, leg});
    EXPECT_EQ(r.loads[0].node, 0u);
}

TEST(SceneFormat, RotationsMayTurnFurtherThanHalf) {
    const Recording r = import_good("camera eye_of_storm eye 1 2 3\nanimate eye_of_storm rotate 0 0 1 0 0  4 0 1 0 360\n");
    ASSERT_EQ(r.nodes.size(), 1u);
    EXPECT_EQ(r.nodes[0].translation[1], 2);
    expect_near(r.cameras.at(0).values.eye, {0, 0, 0});
    ASSERT_EQ(r.channels.size(), 1u);
    EXPECT_EQ(r.channels[0].component, rt_u32(RT_ALL_COMPONENTS));
    EXPECT_EQ(r.channels[0].times.size(), 7u) << "a key each 60 degrees";
    EXPECT_NEAR(r.channels[0].values[4 * 3 + 1], 1, 1e-9) << "half a turn about y at the middle";
}

TEST(SceneFormat, FieldsOfViewMayChange) {
    const Recording r = import_good("camera zoom eye 1 2 3 fov 30\nanimate zoom fov 0 30  2 60\n");
    EXPECT_TRUE(r.nodes.empty()) << "the camera stands still";
    ASSERT_EQ(r.channels.size(), 1u);
    EXPECT_EQ(r.channels[0].moves, rt_u32(RT_MOVES_FOV));
    EXPECT_EQ(r.channels[0].times, (std::vector<double>{0, 2}));
    EXPECT_NEAR(r.channels[0].values.at(1), std::acos(-1.0) / 3, 1e-6);
    ASSERT_EQ(r.clips.size(), 1u);
    EXPECT_EQ(r.clips[0].end_s, 2);
}

TEST(SceneFormat, FillsInDefaults) {
    const Recording r = import_good("camera c\nlight point\nlight directional\nmaterial m\nsphere\nplane\nload x.obj\n");
    expect_near(r.cameras.at(0).values.eye, {0, 0, 5});
    expect_near(r.cameras[0].values.target, {0, 0, 0});
    expect_near(r.cameras[0].values.up, {0, 1, 0});
    EXPECT_NEAR(r.cameras[0].values.fov_y_rad, std::acos(-1.0) / 4, 1e-6);
    expect_near(r.lights.at(0).values.position, {0, 10, 0});
    expect_near(r.lights[0].values.color, {1, 1, 1});
    EXPECT_EQ(r.lights.at(1).values.kind, RT_LIGHT_DIRECTIONAL);
    expect_near(r.lights[1].values.direction, {0, -1, 0});
    const rt_material& m = r.materials.at(0).values;
    expect_near(m.color, {0.7f, 0.7f, 0.7f});
    expect_near(m.specular, {0.15f, 0.15f, 0.15f});
    expect_near(m.emission, {0, 0, 0});
    EXPECT_EQ(m.reflect, 0);
    EXPECT_EQ(m.refract, 0);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.shininess, 32);
    EXPECT_EQ(m.texture, RT_NONE);
    EXPECT_EQ(m.flags, 0u);
    EXPECT_EQ(r.spheres.at(0).radius, 1);
    EXPECT_EQ(r.spheres[0].material, RT_NONE);
    expect_near(r.planes.at(0).normal, {0, 1, 0});
    EXPECT_EQ(r.loads.at(0).name, "");
    EXPECT_EQ(r.loads[0].material, RT_NONE);
    const std::array<float, 12> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    EXPECT_EQ(r.loads[0].world_from_object, identity);
    EXPECT_FALSE(r.has_background);
}

TEST(SceneFormat, ReadsEveryMaterialKey) {
    const Recording r = import_good(
        "material a color .1 .2 .3 reflect .25 refract .5 ior 2.4 specular .5 shininess 80 emission 1 2 3 checker\n"
        "material b specular .1 .2 .3 texture \"my wood.png\"\n"
        "material c texture \"my wood.png\" color .5\n");
    const rt_material& a = r.materials.at(0).values;
    expect_near(a.color, {0.1f, 0.2f, 0.3f});
    EXPECT_EQ(a.reflect, 0.25f);
    EXPECT_EQ(a.refract, 0.5f);
    EXPECT_EQ(a.ior, 2.4f);
    expect_near(a.specular, {0.5f, 0.5f, 0.5f});
    EXPECT_EQ(a.shininess, 80);
    expect_near(a.emission, {1, 2, 3});
    EXPECT_EQ(a.flags, RT_MATERIAL_CHECKER);
    const rt_material& b = r.materials.at(1).values;
    expect_near(b.specular, {0.1f, 0.2f, 0.3f});
    EXPECT_EQ(b.texture, 0u);
    expect_near(b.color, {1, 1, 1});  // a texture without a colour is shown unchanged
    expect_near(r.materials.at(2).values.color, {0.5f, 0.5f, 0.5f});
    EXPECT_EQ(r.textures, std::vector<std::string>{"my wood.png"});  // the importer asks for a texture only once
}

TEST(SceneFormat, ReadsWrapModesOfTextures) {
    const Recording r = import_good(
        "material a texture t.png wrap clamp\n"
        "material b wrap repeat mirror texture t.png\n"
        "material c texture t.png\n"
        "material d texture t.png wrap mirror color .5\n"
        "material e texture t.png wrap clamp clamp\n");
    using Wraps = std::vector<std::pair<rt_u32, rt_u32>>;
    EXPECT_EQ(r.wraps, (Wraps{{RT_WRAP_CLAMP, RT_WRAP_CLAMP},
                              {RT_WRAP_REPEAT, RT_WRAP_MIRROR},
                              {RT_WRAP_REPEAT, RT_WRAP_REPEAT},
                              {RT_WRAP_MIRROR, RT_WRAP_MIRROR}}));
    EXPECT_EQ(r.materials.at(4).values.texture, r.materials.at(0).values.texture);
    EXPECT_TRUE(r.warnings.empty());
    const Recording none = import_good("material a wrap clamp\n");
    ASSERT_EQ(none.warnings.size(), 1u);
    EXPECT_NE(none.warnings[0].find("1:17"), std::string::npos) << none.warnings[0];
}

TEST(SceneFormat, ReadsTexturesByUse) {
    const Recording r = import_good(
        "material a model gltf normal_map dents color_map wood metallic_roughness_map dents roughness .5\n"
        "material b color_map wood emission_map wood opacity .5\n"
        "texture wood \"my wood.png\" scale 2 -3 rotate 90 offset .25 .5 wrap clamp mirror filter nearest\n"
        "texture dents dents.png uv 1 strength .5 scale 4\n"
        "texture bumps bumps.png space height\n"
        "material c normal_map bumps specular_color_map dents\n"
        "texture unused gone.png\n");
    const std::vector<rt_map_desc>& a = r.materials.at(0).maps;
    ASSERT_EQ(a.size(), 3u);
    EXPECT_EQ(a[0].use, RT_MAP_NORMAL);
    EXPECT_EQ(a[0].scale, 0.5f);
    EXPECT_EQ(a[0].set, 1u);
    EXPECT_EQ(a[1].use, RT_MAP_COLOR);
    EXPECT_EQ(a[1].scale, 1);
    EXPECT_EQ(a[1].set, 0u);
    // (1, 0) -> (2, 0) -> (0, 2) -> (.25, 2.5), and (0, 1) -> (0, -3) -> (3, 0) -> (3.25, .5)
    const float wood[6] = {0, 3, 0.25f, 2, 0, 0.5f};
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(a[1].matrix[k], wood[k], 1e-6) << k;
    EXPECT_EQ(a[2].use, RT_MAP_METALLIC_ROUGHNESS);
    EXPECT_EQ(a[2].texture, a[0].texture);  // both are numbers, so it is one texture
    EXPECT_EQ(a[2].scale, 1);               // only normals and occlusion have a strength
    const std::vector<rt_map_desc>& c = r.materials.at(2).maps;
    EXPECT_NE(c[1].texture, a[0].texture);  // a colour is sRGB
    EXPECT_EQ(r.looks.at(c[1].texture).space, RT_SPACE_SRGB);
    EXPECT_EQ(r.looks.at(c[0].texture).space, RT_SPACE_HEIGHT);
    EXPECT_EQ(r.looks.at(a[0].texture).space, RT_SPACE_LINEAR);
    EXPECT_EQ(r.looks.at(a[1].texture).space, RT_SPACE_SRGB);
    EXPECT_EQ(r.looks.at(a[1].texture).filter, RT_FILTER_NEAREST);
    EXPECT_EQ(r.wraps.at(a[1].texture), (std::pair<rt_u32, rt_u32>{RT_WRAP_CLAMP, RT_WRAP_MIRROR}));
    EXPECT_EQ(r.textures, (std::vector<std::string>{"dents.png", "my wood.png", "bumps.png", "dents.png"}));
    // What a texture multiplies is 1 where it is not given.
    expect_near(r.materials[1].values.color, {1, 1, 1});
    expect_near(r.materials[1].values.emission, {1, 1, 1});
    expect_near(r.materials[2].values.emission, {0, 0, 0});
    EXPECT_EQ(r.materials[0].values.roughness, 0.5f);
    EXPECT_TRUE(r.warnings.empty());
}

// A statement may have any number of keys: the last ones are told from the first.
TEST(SceneFormat, AMaterialMayHaveItsFirstKeyAndItsLast) {
    const Recording r =
        import_good("material a model lambert texture t.png wrap clamp color .5 opacity_map t\ntexture t t.png\n");
    EXPECT_EQ(r.materials.at(0).maps.size(), 1u);
    EXPECT_EQ(r.wraps.at(0).first, RT_WRAP_CLAMP);
}

TEST(SceneFormat, MissingTextureIsNoError) {
    Recording r;
    r.refuse_textures = true;
    import_text("material m texture gone.png\nsphere material m\n", r);
    EXPECT_EQ(r.status, RT_OK);
    EXPECT_EQ(r.materials.at(0).values.texture, RT_NONE);
    r = {};
    r.refuse_textures = true;
    import_text("texture t gone.png\nmaterial m normal_map t\nsphere material m\n", r);
    EXPECT_EQ(r.status, RT_OK);
    EXPECT_EQ(r.materials.at(0).maps.at(0).texture, RT_NONE);
}

TEST(SceneFormat, SharesAboveOneAreScaledWithAWarning) {
    const Recording r = import_good("material m reflect .8 refract .8\nmaterial exact reflect .1 refract .9\n");
    EXPECT_FLOAT_EQ(r.materials.at(0).values.reflect, 0.5f);
    EXPECT_FLOAT_EQ(r.materials[0].values.refract, 0.5f);
    ASSERT_EQ(r.warnings.size(), 1u);
    EXPECT_EQ(r.warnings[0],
              "test.scene:1:31: `reflect` and `refract` of material `m` add up to 1.6; both are scaled down to add up to 1");
}

TEST(SceneFormat, LightsHaveIntensityNameAndDirectionOfTravel) {
    const Recording r =
        import_good("light directional direction 0 -3 4 color 1 .5 0 intensity 2 name sun\nlight point intensity 0.5\n");
    expect_near(r.lights.at(0).values.direction, {0, -0.6f, 0.8f});
    expect_near(r.lights[0].values.color, {2, 1, 0});
    EXPECT_EQ(r.lights[0].name, "sun");
    expect_near(r.lights.at(1).values.color, {0.5f, 0.5f, 0.5f});
}

TEST(SceneFormat, PlaneNormalIsNormalised) {
    const Recording r = import_good("plane normal 0 0 5 offset -2\n");
    expect_near(r.planes.at(0).normal, {0, 0, 1});
    EXPECT_EQ(r.planes[0].offset, -2);
}

TEST(SceneFormat, PlacesAsScaleThenRotationsThenTranslation) {
    // The order of the keys does not matter, except among rotations.
    const char* lines[] = {"load a.obj translate 1 2 3 rotate 0 0 1 90 scale 2 3 4\n",
                           "load a.obj scale 2 3 4 translate 1 2 3 rotate 0 0 1 90\n"};
    for (const char* line : lines) {
        const Recording r = import_good(line);
        expect_near(transformed(r.loads.at(0).world_from_object, {1, 0, 0}), {1, 4, 3});
        expect_near(transformed(r.loads[0].world_from_object, {0, 1, 0}), {-2, 2, 3});
        expect_near(transformed(r.loads[0].world_from_object, {0, 0, 1}), {1, 2, 7});
    }
    const Recording twice = import_good("load a.obj rotate 1 0 0 90 rotate 0 1 0 90\n");
    expect_near(transformed(twice.loads.at(0).world_from_object, {0, 1, 0}), {1, 0, 0});  // y -> z -> x
    const Recording mirror = import_good("load a.obj scale -1 1 1\n");
    expect_near(transformed(mirror.loads.at(0).world_from_object, {1, 1, 1}), {-1, 1, 1});
}

TEST(SceneFormat, KeepsTheOrderOfGeometry) {
    const Recording r = import_good(
        "material red color 1 0 0\n"
        "triangle vertices 0 0 0 1 0 0 0 1 0 material red\n"
        "triangle vertices 0 0 1 1 0 1 0 1 1\n"
        "sphere\n"
        "triangle vertices 0 0 2 1 0 2 0 1 2\n"
        "load x.obj\n"
        "polygon vertices 0 0 0 1 0 0 0 1 0\n");
    EXPECT_EQ(r.order, (std::vector<std::string>{"mesh", "sphere", "mesh", "load", "polygon"}));
    EXPECT_EQ(r.meshes.at(0).face_materials, (std::vector<rt_u32>{0, RT_NONE}));
    EXPECT_EQ(r.meshes[0].positions.at(11), 1.0f);
    EXPECT_EQ(r.instanced_meshes, (std::vector<rt_u32>{0, 1}));
}

TEST(SceneFormat, AcceptsConcavePolygonsAndDegenerateTriangles) {
    const Recording r = import_good(
        "polygon vertices 0 0 0  4 0 0  4 0 4  2 0 1  0 0 4\n"
        "triangle vertices 0 0 0 1 1 1 2 2 2\n"
        "triangle vertices 5 5 5 5 5 5 5 5 5\n");
    EXPECT_EQ(r.polygons.size(), 1u);
    EXPECT_EQ(r.meshes.at(0).indices.size(), 6u);
    ASSERT_EQ(r.warnings.size(), 1u);
    EXPECT_EQ(r.warnings[0], "test.scene:2:10: a triangle without area is invisible (further ones are not reported)");
}

TEST(SceneFormat, PlanarityIsRelativeToSizeAndPlace) {
    import_good("polygon vertices 1000000 0 0  1000001 0 0  1000001 1 0  1000000 1 0\n");
    import_good("polygon vertices 0 0 0  1000 0 0  1000 1000 .05  0 1000 0\n");
    import_good("polygon vertices 0 0 0  1e-6 0 0  1e-6 1e-6 0  0 1e-6 0\n");
}

TEST(SceneFormat, AcceptsAnyLineEndAndEncodingOfText) {
    const Recording r = import_good("\xEF\xBB\xBFsphere\r\nsphere\rsphere\n\t sphere # caf\xE9 in Latin-1, in a comment\n");
    EXPECT_EQ(r.spheres.size(), 4u);
}

TEST(SceneFormat, QuotedNamesHoldAnything) {
    const Recording r = import_good(
        "material \"dark # blue \xC3\xA9\"\nmaterial \"color\"\nsphere material \"dark # blue \xC3\xA9\"\nsphere material "
        "\"color\"\n");
    EXPECT_EQ(r.materials.at(0).name, "dark # blue \xC3\xA9");
    EXPECT_EQ(r.spheres.at(1).material, 1u);
}

TEST(SceneFormat, NumbersDoNotDependOnLocale) {
    const char* old = std::setlocale(LC_NUMERIC, nullptr);
    const std::string saved = old != nullptr ? old : "C";
    std::setlocale(LC_NUMERIC, "de_DE.UTF-8");  // if the locale is not installed, the test still parses numbers
    const Recording r = import_good("sphere radius 2.5 center +1.5 -.25 1e-2\n");
    std::setlocale(LC_NUMERIC, saved.c_str());
    EXPECT_EQ(r.spheres.at(0).radius, 2.5f);
    expect_near(r.spheres[0].center, {1.5f, -0.25f, 0.01f});
}

TEST(SceneFormat, SinkFailureNamesTheStatement) {
    Recording r;
    r.refuse_loads = true;
    import_text("sphere\nload \"gone.fbx\"\nsphere\n", r);
    EXPECT_EQ(r.status, RT_FAILED);
    EXPECT_EQ(r.why, "test.scene:2:6: the sink refused gone.fbx");
    EXPECT_EQ(r.spheres.size(), 1u);

    Recording other;
    other.refuse_spheres = true;
    import_text("camera c\n  sphere\n", other);
    EXPECT_EQ(other.status, RT_FAILED);
    EXPECT_EQ(other.log, std::vector<std::string>{"test.scene:2:3: the import stopped at this statement"});
}

TEST(SceneFormat, StopsWhenCancelled) {
    std::string text;
    for (int i = 0; i < 20000; ++i) text += "sphere\n";
    Recording reading;
    reading.reports_before_cancel = 2;
    import_text(text, reading);
    EXPECT_EQ(reading.status, RT_CANCELLED);
    EXPECT_EQ(reading.spheres.size(), 0u);
    Recording handing_over;
    handing_over.reports_before_cancel = 10;
    import_text(text, handing_over);
    EXPECT_EQ(handing_over.status, RT_CANCELLED);
    EXPECT_LT(handing_over.spheres.size(), 20000u);
}

TEST(SceneFormat, EditsBecomeTheWordsOfTheCommandLine) {
    const Recording r = import_good(
        "edit instance 3 hidden 1 scale 2 translate 1 -.5 .1 rotate 0 90 0 mask 3\n"
        "edit material 0 color 1 .5 0 reflect .25 specular .5\n"
        "edit light 1 off\n"
        "edit light 2 directional direction 0 -2 0 color .5\n"
        "edit light 3 point color 1 2 3\n"
        "edit sky gradient visible false horizon .5 zenith 1 2 3\n"
        "edit sky background\n");
    EXPECT_EQ(r.edits,
              (std::vector<std::string>{"instance.3.hidden=1", "instance.3.scale=2,2,2", "instance.3.translate=1,-0.5,0.1",
                                        "instance.3.rotate=0,90,0", "instance.3.mask=3", "material.0.color=1,0.5,0",
                                        "material.0.reflect=0.25", "material.0.specular=0.5,0.5,0.5", "light.1=off",
                                        "light.2=directional,0,-1,0,0.5,0.5,0.5", "light.3=point,0,10,0,1,2,3", "sky=gradient",
                                        "sky.visible=false", "sky.horizon=0.5,0.5,0.5", "sky.zenith=1,2,3", "sky=background"}));
    EXPECT_NE(import_text("edit instance 1 radius 3\n").why, "");
    EXPECT_NE(import_text("edit instance 1 mask 256\n").why, "");
    EXPECT_NE(import_text("edit instance 1 mask 1.5\n").why, "");
    EXPECT_NE(import_text("edit material 1 ior 0\n").why, "");
    EXPECT_NE(import_text("edit camera 1\n").why, "");
    EXPECT_NE(import_text("edit sky constant zenith 1\n").why, "");
    EXPECT_NE(import_text("edit sky background strength 1\n").why, "");
}

TEST(SceneFormat, LightsOfAllKinds) {
    const Recording r = import_good(
        "light spot position 1 2 3 direction 0 -2 0 color 4 5 6 angle 60 inner 40 falloff square\n"
        "light sun direction 0 -1 0 irradiance 3 angle .53\n"
        "light rect center 0 2 0 u 1 0 0 v 0 0 .5 radiance 17 12 4 name panel\n"
        "light disc center 1 1 1 normal 0 -3 0 radius 2 radiance 1 two_sided\n"
        "light sphere center 0 1 0 radius .5 radiance 2 intensity 3\n"
        "light point falloff none\n");
    ASSERT_EQ(r.lights.size(), 6u);
    for (rt_u32 i = 0; i < 5; ++i) EXPECT_EQ(r.lights[i].light.kind, RT_LIGHT_SPOT + i);
    const rt_light &spot = r.lights[0].light, &sun = r.lights[1].light, &rect = r.lights[2].light, &disc = r.lights[3].light,
                   &sphere = r.lights[4].light;
    expect_near(spot.position, {1, 2, 3});
    expect_near(spot.normal, {0, -1, 0});
    expect_near(spot.color, {4, 5, 6});
    EXPECT_EQ(spot.flags, RT_LIGHT_FALLOFF);
    EXPECT_FLOAT_EQ(spot.cos_outer, 0.8660254f) << "30 degrees: half of the angle";
    EXPECT_FLOAT_EQ(spot.cos_inner, 0.9396926f) << "20 degrees";
    expect_near(sun.position, {0, 1, 0});
    expect_near(sun.color, {3, 3, 3});
    EXPECT_NEAR(sun.area / 6.72056e-5, 1, 1e-4) << "pi sin^2 of 0.265 degrees";
    expect_near(rect.normal, {0, -1, 0});
    EXPECT_FLOAT_EQ(rect.area, 2);
    expect_near(rect.color, {17, 12, 4});
    EXPECT_EQ(r.lights[2].name, "panel");
    expect_near(disc.normal, {0, -1, 0});
    EXPECT_EQ(disc.flags, RT_LIGHT_TWO_SIDED);
    EXPECT_FLOAT_EQ(disc.area, 25.132741f) << "both sides";
    EXPECT_FLOAT_EQ(sphere.area, 3.1415927f);
    expect_near(sphere.color, {6, 6, 6});
    EXPECT_EQ(r.lights[5].light.flags, 0u);
}

TEST(SceneFormat, ModelsHaveSharesForWhittedsTracers) {
    const Recording r = import_good(
        "material wall model lambert color .5\n"
        "material gold model conductor color 1 .8 .3 roughness .25 compensate false\n"
        "material mirror model conductor color .9\n"
        "material glass model dielectric absorption 1 2 3 ior 1.33\n"
        "material own roughness .25 reflect .1 model conductor one_sided\n"
        "material plain roughness .5 absorption 1\n");
    const auto& m = r.materials;
    ASSERT_EQ(m.size(), 6u);
    EXPECT_EQ(m[0].values.model, RT_MODEL_LAMBERT);
    expect_near(m[0].values.specular, {0, 0, 0});
    EXPECT_EQ(m[1].values.model, RT_MODEL_CONDUCTOR);
    EXPECT_EQ(m[1].values.flags, RT_MATERIAL_SINGLE_SCATTER);
    EXPECT_FLOAT_EQ(m[1].values.reflect, 0.75f) << "1 - roughness";
    expect_near(m[1].values.specular, {1, 0.8f, 0.3f});
    EXPECT_EQ(m[2].values.reflect, 1);
    EXPECT_EQ(m[3].values.refract, 1);
    EXPECT_FLOAT_EQ(m[3].values.ior, 1.33f);
    expect_near(m[3].values.absorption, {1, 2, 3});
    EXPECT_FLOAT_EQ(m[4].values.reflect, 0.1f) << "the statement says it, wherever it stands";
    EXPECT_EQ(m[4].values.flags, RT_MATERIAL_ONE_SIDED);
    EXPECT_EQ(m[5].values.model, RT_MODEL_WHITTED);
    EXPECT_EQ(m[5].values.reflect, 0) << "Whitted's own shares stay";
}

TEST(SceneFormat, CamerasHaveALens) {
    const Recording r = import_good("camera a aperture .02 focus 7\ncamera b\n");
    EXPECT_FLOAT_EQ(r.cameras.at(0).values.aperture, 0.02f);
    EXPECT_FLOAT_EQ(r.cameras[0].values.focus, 7);
    EXPECT_EQ(r.cameras.at(1).values.aperture, 0);
}

TEST(SceneFormat, EditsOfAllKinds) {
    const Recording r = import_good(
        "edit material 1 model conductor roughness .25 one_sided checker false\n"
        "edit light 0 spot position 1 2 3 angle 50 falloff square\n"
        "edit light 1 sun color .5\n");
    EXPECT_EQ(r.edits,
              (std::vector<std::string>{"material.1.model=conductor", "material.1.roughness=0.25", "material.1.one_sided=true",
                                        "material.1.checker=false", "light.0=spot,1,2,3,0,-1,0,1,1,1,50,45",
                                        "light.0.falloff=square", "light.1=sun,0,-1,0,0.5,0.5,0.5,0.53"}));
}

}  // namespace
