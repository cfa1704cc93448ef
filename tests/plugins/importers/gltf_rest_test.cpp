// gltf_rest_test.cpp -- at rest a scene looks as its file says: skins and the weights of morphs act without a clip.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace clarity::test
