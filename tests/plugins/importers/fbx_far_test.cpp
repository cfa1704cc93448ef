// fbx_far_test.cpp -- vertices of FBX files far from 0, as surveys in UTM have them, keep their shape.
#include <gtest/gtest.h>

#include "fbx_model.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

class FbxFar : public FbxForms {
 protected:
    // 5 by 3 centimetres, 5e6 and 4.5e6 m from 0: floats have steps of 0.5 there.
    static constexpr double kX = 5e6 + 0.01, kY = 4.5e6 + 0.02;
    static FbxNode far_geometry() {
        return node(
            "Geometry", {whole(1), text("Geometry::Stone"), text("Mesh")},
            {node("Vertices", {Numbers{kX, kY, 100, kX + 0.05, kY, 100, kX + 0.05, kY + 0.03, 100, kX, kY + 0.03, 100}}),
             node("PolygonVertexIndex", {Indices{0, 1, 2, -4}})});
    }
    static void expect_place(const Scene& scene, double x, double y) {
        const Bounds bounds = scene.bounds();
        for (const std::string& warning : scene.warnings) ADD_FAILURE() << warning;
        EXPECT_NEAR(scene.surface_area(), 0.05 * 0.03, 1e-6);
        EXPECT_NEAR(bounds.min[0] + scene.origin[0], x, 1e-4);
        EXPECT_NEAR(bounds.min[1] + scene.origin[1], y, 1e-4);
        EXPECT_NEAR(bounds.max[0] + scene.origin[0], x + 0.05, 1e-4);
    }
};
INSTANTIATE_TEST_SUITE_P(Forms, FbxFar, kFbxForms, fbx_form_name);

TEST_P(FbxFar, KeepsVerticesAndPlaces) {
    const std::vector<FbxNode> plain = {far_geometry(), model(2, "A")};
    expect_place(import(plain, {link(2, 0), link(1, 2)}), kX, kY);
    const FbxNode moved =
        model(2, "A", {property("GeometricTranslation", {2e6, 0, 0}), property("Lcl Translation", {0, 1e6, 0})});
    expect_place(import({far_geometry(), moved}, {link(2, 0), link(1, 2)}), kX + 2e6, kY + 1e6);
}

TEST_P(FbxFar, KeepsWhatShapesMove) {
    const Scene scene = import(
        {far_geometry(), model(2, "A"),
         node("Deformer", {whole(6), text("Deformer::"), text("BlendShape")}, {node("Version", {whole(100)})}),
         node("Deformer", {whole(7), text("SubDeformer::Right"), text("BlendShapeChannel")},
              {node("Properties70", {}, {property("DeformPercent", {50})})}),
         node("Geometry", {whole(8), text("Geometry::Right"), text("Shape")},
              {node("Indexes", {Indices{0, 1, 2, 3}}), node("Vertices", {Numbers{2, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0}})})},
        {link(2, 0), link(1, 2), link(6, 1), link(7, 6), link(8, 7)});
    expect_place(scene, kX + 1, kY);
}

// Skinned vertices are floats in the space of their file.
TEST_P(FbxFar, SaysThatASkinLosesDetails) {
    const Numbers identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const std::vector<FbxNode> objects = {
        far_geometry(), model(2, "A"),
        node("Deformer", {whole(3), text("Deformer::"), text("Skin")}, {node("Version", {whole(101)})}),
        node("Deformer", {whole(4), text("SubDeformer::"), text("Cluster")},
             {node("Indexes", {Indices{0, 1, 2, 3}}), node("Weights", {Numbers{1, 1, 1, 1}}), node("Transform", {identity})}),
        node("Model", {whole(5), text("Model::Bone"), text("LimbNode")},
             {node("Version", {whole(232)}), node("Properties70", {}, {property("Lcl Translation", {0, 10, 0})})})};
    const std::vector<FbxNode> links = {link(2, 0), link(5, 0), link(1, 2), link(3, 1), link(4, 3), link(5, 4)};
    const Scene scene = import(objects, links);
    EXPECT_TRUE(
        warns_of(scene, "'Stone' lies far from the origin (near 5e+06, 4.5e+06, 100), where its bones move it in floats"));
    EXPECT_NEAR(scene.bounds().min[1] + scene.origin[1], kY + 10, 1) << "in its place, up to the steps of floats";
}

}  // namespace
}  // namespace clarity::test
