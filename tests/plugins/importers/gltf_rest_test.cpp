// gltf_rest_test.cpp -- at rest a scene looks as its file says: skins and the weights of morphs act without a clip.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_model.hpp"
#include "import/import.hpp"
#include "measure.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

// A unit square whose node is at x = 10. Its only joint, nodes[1], stands at the origin.
Model skinned() {
    Model model = quad();
    model.indices({0, 1, 3, 0, 3, 2});
    model.primitive()["attributes"]["JOINTS_0"] = model.add(std::vector<uint8_t>(16, 0), "VEC4", 5121, 4);
    std::vector<float> weights;
    for (int v = 0; v < 4; ++v) weights.insert(weights.end(), {1, 0, 0, 0});
    model.primitive()["attributes"]["WEIGHTS_0"] = model.add(weights, "VEC4", 5126, 4);
    model["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {10, 0, 0}}}, {{"name", "joint"}}};
    model["scenes"][0]["nodes"] = {0, 1};
    model["skins"] = {{{"joints", {1}}}};
    return model;
}

// The square, whose morph of weight 1 lifts it by 1.
Model lifted() {
    Model model = quad();
    model.indices({0, 1, 3, 0, 3, 2});
    model.primitive()["targets"] = {
        {{"POSITION", model.add(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3)}}};
    return model;
}

class GltfRest : public testing::Test {
 protected:
    Scene import(Model& model, bool undeformed = false) {
        return import_file(folder_.write("model.gltf", model.text()), undeformed);
    }
    static void expect_box(const Scene& scene, const std::array<float, 3>& min, const std::array<float, 3>& max) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(scene.bounds().min[k], min[k], 1e-5) << k;
            EXPECT_NEAR(scene.bounds().max[k], max[k], 1e-5) << k;
        }
    }
    Scratch folder_;
};

TEST_F(GltfRest, IgnoresTheNodeOfASkinnedMesh) {
    Model model = skinned();
    expect_box(import(model), {0, 0, 0}, {1, 1, 0});
    model["nodes"][0]["scale"] = {0, 0, 0};
    const Scene flat = import(model);
    expect_box(flat, {0, 0, 0}, {1, 1, 0});
    EXPECT_EQ(flat.meshes.size(), 1u) << "nothing is flattened";
    model["nodes"][0] = {{"mesh", 0}, {"skin", 0}};
    model["nodes"].push_back({{"children", {0}}, {"translation", {0, 7, 0}}});
    model["scenes"][0]["nodes"] = {2, 1};
    expect_box(import(model), {0, 0, 0}, {1, 1, 0});
}

TEST_F(GltfRest, FollowsTheJoints) {
    Model model = skinned();
    model["nodes"][1]["translation"] = {0, 0, 4};
    const Scene scene = import(model);
    expect_box(scene, {0, 0, 4}, {1, 1, 4});
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    expect_box(posed(scene, evaluate(scene, "", 0)), {0, 0, 4}, {1, 1, 4});
    // A bind matrix takes the joint's place at binding away.
    model["skins"][0]["inverseBindMatrices"] =
        model.add(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -3, 1}, "MAT4", 5126, 16);
    expect_box(import(model), {0, 0, 1}, {1, 1, 1});
}

TEST_F(GltfRest, TwoNodesMayShareASkinnedMesh) {
    Model model = skinned();
    model["nodes"].push_back({{"mesh", 0}, {"skin", 0}, {"translation", {0, 90, 0}}});
    model["nodes"].push_back({{"mesh", 0}, {"translation", {0, 20, 0}}});
    model["scenes"][0]["nodes"] = {0, 1, 2, 3};
    const Scene scene = import(model);
    EXPECT_EQ(scene.placed_triangle_count(), 6u);
    expect_box(scene, {0, 0, 0}, {1, 21, 0});  // without the skin the mesh follows its node
}

// The specification asks for weights. Without them a vertex follows the first joint, but never the node of the mesh.
TEST_F(GltfRest, VerticesWithoutWeightsFollowTheFirstJoint) {
    Model model = skinned();
    model["nodes"][1]["translation"] = {0, 0, 4};
    model["meshes"][0]["primitives"].push_back(model.primitive());
    json& bare = model["meshes"][0]["primitives"][1];
    bare["attributes"].erase("JOINTS_0");
    bare["attributes"].erase("WEIGHTS_0");
    const Scene scene = import(model);
    expect_box(scene, {0, 0, 4}, {1, 1, 4});
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("4 vertices of meshes with skins have no weights"), std::string::npos);
    model["meshes"][0]["primitives"].erase(0);
    expect_box(import(model), {0, 0, 4}, {1, 1, 4});
}

TEST_F(GltfRest, TakesTheWeightsOfTheNodeOrElseOfTheMesh) {
    Model model = lifted();
    expect_box(import(model), {0, 0, 0}, {1, 1, 0});
    model["meshes"][0]["weights"] = {0.5};
    expect_box(import(model), {0, 0, 0.5f}, {1, 1, 0.5f});
    model["nodes"][0]["weights"] = {2};
    model["nodes"][0]["translation"] = {0, 0, 10};
    const Scene scene = import(model);
    expect_box(scene, {0, 0, 12}, {1, 1, 12});
    expect_box(posed(scene, evaluate(scene, "", 0)), {0, 0, 12}, {1, 1, 12});  // the morph is not added twice
    model["nodes"][0]["weights"] = {0};
    expect_box(import(model), {0, 0, 10}, {1, 1, 10});
}

TEST_F(GltfRest, MorphsComeBeforeSkins) {
    Model model = skinned();
    model.primitive()["targets"] = {
        {{"POSITION", model.add(std::vector<float>{1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3", 5126, 3)}}};
    model["meshes"][0]["weights"] = {1};
    model["nodes"][1]["scale"] = {3, 1, 1};
    expect_box(import(model), {3, 0, 0}, {6, 1, 0});
}

TEST_F(GltfRest, AClipStartsFromTheStoredVertices) {
    Model model = lifted();
    model["meshes"][0]["weights"] = {1};
    const size_t times = model.add(std::vector<float>{0, 1}, "SCALAR", 5126, 1),
                 values = model.add(std::vector<float>{0, 3}, "SCALAR", 5126, 1);
    model["animations"] = {{{"samplers", {{{"input", times}, {"output", values}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    const Scene scene = import(model);
    expect_box(scene, {0, 0, 1}, {1, 1, 1});
    expect_box(posed(scene, evaluate(scene, "", 0)), {0, 0, 0}, {1, 1, 0});
    expect_box(posed(scene, evaluate(scene, "", 1)), {0, 0, 3}, {1, 1, 3});
}

TEST_F(GltfRest, StaysAsStoredWhereTheUserAsksForIt) {
    Model model = skinned();
    model["nodes"][1]["translation"] = {0, 0, 4};
    const Scene scene = import(model, true);
    expect_box(scene, {10, 0, 0}, {11, 1, 0});
    expect_box(posed(scene, evaluate(scene, "", 0)), {0, 0, 4}, {1, 1, 4});
    Model morph = lifted();
    morph["meshes"][0]["weights"] = {1};
    expect_box(import(morph, true), {0, 0, 0}, {1, 1, 0});
}

// A joint may lead to numbers that no scene takes: the mesh is there as it is stored, and that is said.
TEST_F(GltfRest, KeepsMeshesThatTheirSkinsTearApart) {
    Model model = skinned();
    model["nodes"][1]["scale"] = {1e10, 1, 1};
    model["skins"][0]["inverseBindMatrices"] =
        model.add(std::vector<float>{1e10f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 5126, 16);
    const Scene scene = import(model);
    expect_box(scene, {10, 0, 0}, {11, 1, 0});
    ASSERT_FALSE(scene.warnings.empty());
    EXPECT_NE(scene.warnings.back().find("shown as they are stored"), std::string::npos) << scene.warnings.back();
}

// The light from all around of EXT_lights_image_based.

using Rgba = std::array<int, 4>;

// A picture of 2 x 2 texels, the upper row first: TGA.
std::string tga(const std::array<Rgba, 4>& texels) {
    std::string out("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\2\0\x20\x28", 18);
    for (const Rgba& t : texels)
        for (const int k : {2, 1, 0, 3}) out += static_cast<char>(t[static_cast<size_t>(k)]);
    return out;
}
std::string plain(const Rgba& color) {
    return tga({color, color, color, color});
}

class GltfSky : public testing::Test {
 protected:
    // Faces of pure colours: +X red, -X green, +Y blue, -Y yellow, +Z cyan, -Z magenta.
    std::vector<std::string> faces_ = {plain({255, 0, 0, 255}),   plain({0, 255, 0, 255}),   plain({0, 0, 255, 255}),
                                       plain({255, 255, 0, 255}), plain({0, 255, 255, 255}), plain({255, 0, 255, 255})};
    Scene import(const json& more = json::object(), int levels = 1) {
        Model model;
        model.positions({0, 0, 0, 1, 0, 0, 1, 1, 0});
        model.indices({0, 1, 2});
        json list = json::array();
        for (size_t i = 0; i < faces_.size(); ++i) {
            model["images"].push_back({{"uri", "data:image/png;base64," + base64(faces_[i])}});
            list.push_back(i);
        }
        json light = {{"specularImageSize", 2}, {"specularImages", json::array()}};
        for (int i = 0; i < levels; ++i) light["specularImages"].push_back(list);
        light.update(more);
        model["extensions"] = {{"EXT_lights_image_based", {{"lights", {light}}}}};
        model["scenes"][0]["extensions"] = {{"EXT_lights_image_based", {{"light", 0}}}};
        return import_file(folder_.write("a.gltf", model.text()));
    }
    // What the picture of the sky has in a direction.
    static std::array<float, 3> towards(const Scene& scene, double x, double y, double z) {
        const SkyValues& sky = scene.sky.values;
        const double length = std::sqrt(x * x + y * y + z * z), pi = std::acos(-1.0);
        const double u = 0.5 + std::atan2(z, x) / (2 * pi), v = std::acos(y / length) / pi;
        const size_t column = std::min<size_t>(sky.width - 1, size_t(u * sky.width)),
                     row = std::min<size_t>(sky.height - 1, size_t(v * sky.height)), at = 3 * (row * sky.width + column);
        return {scene.sky.texels[at], scene.sky.texels[at + 1], scene.sky.texels[at + 2]};
    }
    using Color = std::array<float, 3>;
    Scratch folder_;
};

TEST_F(GltfSky, ShowsTheFacesOfACube) {
    const Scene scene = import({{"intensity", 2.5}});
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
    ASSERT_EQ(scene.sky.values.kind, RT_SKY_PICTURE);
    EXPECT_EQ(scene.sky.values.width, 8u);
    EXPECT_EQ(scene.sky.values.height, 4u);
    EXPECT_EQ(scene.sky.values.strength, 2.5f);
    EXPECT_EQ(towards(scene, 1, -0.1, 0.1), (Color{1, 0, 0}));
    EXPECT_EQ(towards(scene, -1, -0.1, 0.1), (Color{0, 1, 0}));
    EXPECT_EQ(towards(scene, 0.1, 1, 0.1), (Color{0, 0, 1}));
    EXPECT_EQ(towards(scene, 0.1, -1, 0.1), (Color{1, 1, 0}));
    EXPECT_EQ(towards(scene, 0.1, -0.1, 1), (Color{0, 1, 1}));
    EXPECT_EQ(towards(scene, 0.1, -0.1, -1), (Color{1, 0, 1}));
}

// As they are seen from the inside: to the right of +X is +Z, and above is +Y. A texel of this sky is 45 degrees wide.
TEST_F(GltfSky, FacesAreNotMirrored) {
    const std::string black = plain({0, 0, 0, 255});
    const Rgba n = {0, 0, 0, 255}, white = {255, 255, 255, 255};
    const std::string upper_right = tga({n, white, n, n});
    const double a = 0.6;
    const struct {
        size_t face;
        std::array<double, 3> lit, opposite;  // towards the upper right, and towards the lower left
    } rows[] = {{0, {1, a, a}, {1, -a, -a}},   {1, {-1, a, -a}, {-1, -a, a}}, {2, {-a, 1, -a}, {a, 1, a}},
                {3, {-a, -1, a}, {a, -1, -a}}, {4, {-a, a, 1}, {a, -a, 1}},   {5, {a, a, -1}, {-a, -a, -1}}};
    for (const auto& row : rows) {
        faces_.assign(6, black);
        faces_[row.face] = upper_right;
        const Scene scene = import();
        EXPECT_GT(towards(scene, row.lit[0], row.lit[1], row.lit[2])[0], 0.3f) << row.face;
        EXPECT_LT(towards(scene, row.opposite[0], row.opposite[1], row.opposite[2])[0], 0.1f) << row.face;
    }
}

// A quarter about +Y leads from +X to -Z.
TEST_F(GltfSky, Turns) {
    const double half = std::sqrt(0.5);
    const Scene scene = import({{"rotation", {0, half, 0, half}}});
    EXPECT_EQ(towards(scene, 0.1, -0.1, -1), (Color{1, 0, 0}));
    EXPECT_EQ(towards(scene, 1, -0.1, 0.1), (Color{0, 1, 1}));
    const Scene tilted = import({{"rotation", {half, 0, 0, half}}});
    EXPECT_EQ(towards(tilted, 0.1, -0.1, 1), (Color{0, 0, 1})) << "a quarter about +X leads from +Y to +Z";
}

// RGBD: colours are divided by alpha.
TEST_F(GltfSky, HasLightAboveOne) {
    faces_[0] = plain({255, 128, 0, 51});
    const std::array<float, 3> light = towards(import(), 1, -0.1, 0.1);
    EXPECT_NEAR(light[0], 5, 1e-5);
    EXPECT_NEAR(light[1], 5 * 0.2158605, 1e-4);
}

TEST_F(GltfSky, SaysWhatIsLeftOut) {
    const Scene blurred = import(json::object(), 3);
    EXPECT_EQ(blurred.sky.values.kind, RT_SKY_PICTURE);
    ASSERT_EQ(blurred.warnings.size(), 1u);
    EXPECT_NE(blurred.warnings[0].find("the blurred ones and the irradiance are left out"), std::string::npos);
    faces_.pop_back();
    const Scene five = import();
    ASSERT_EQ(five.warnings.size(), 1u);
    EXPECT_NE(five.warnings[0].find("expected at least one list of 6 images"), std::string::npos) << five.warnings[0];
    EXPECT_EQ(five.sky.values.kind, RT_NONE);
    faces_.push_back("no picture");
    const Scene broken = import();
    ASSERT_EQ(broken.warnings.size(), 1u);
    EXPECT_NE(broken.warnings[0].find("face 5"), std::string::npos) << broken.warnings[0];
    EXPECT_EQ(broken.sky.values.kind, RT_NONE);
}

}  // namespace
}  // namespace clarity::test
