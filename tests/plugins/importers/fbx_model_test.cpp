// fbx_model_test.cpp -- what FBX files of all ages say about a scene, from small files made here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "fbx_model.hpp"
#include "scene/motion/pose.hpp"
#include "support/errors.hpp"

namespace clarity::test {
namespace {

class FbxModelForm : public FbxForms {};
INSTANTIATE_TEST_SUITE_P(Forms, FbxModelForm, kFbxForms, fbx_form_name);

TEST_P(FbxModelForm, ShowsAMeshBelowEachModelThatHasIt) {
    const Scene scene = import({geometry(1), model(3, "Left", {property("Lcl Translation", {-5, 0, 0})}),
                                model(4, "Right", {property("Lcl Translation", {5, 0, 0})})},
                               {link(3, 0), link(4, 0), link(1, 3), link(1, 4)});
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.bounds().min[0], -5);
    EXPECT_EQ(scene.bounds().max[0], 6);
}

// A node has one parent: the last one in the list of objects, in whichever order the connections come.
TEST_P(FbxModelForm, ShowsANodeOfSeveralParentsOnce) {
    const std::vector<FbxNode> objects = {geometry(1), model(2, "Shown"),
                                          model(3, "Left", {property("Lcl Translation", {-5, 0, 0})}),
                                          model(4, "Right", {property("Lcl Translation", {5, 0, 0})})};
    const auto expect_right = [&](const std::vector<FbxNode>& links) {
        const Scene scene = import(objects, links);
        ASSERT_EQ(scene.instances.size(), 1u);
        EXPECT_EQ(scene.bounds().min[0], 5);
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_NE(scene.warnings[0].find("the node 'Shown' hangs from several nodes; it is shown below 'Right' only"),
                  std::string::npos)
            << scene.warnings[0];
    };
    expect_right({link(3, 0), link(4, 0), link(2, 3), link(2, 4), link(1, 2)});
    expect_right({link(3, 0), link(4, 0), link(2, 4), link(2, 3), link(1, 2)});
    expect_right({link(2, 0), link(3, 0), link(4, 0), link(2, 4), link(1, 2)});
    // The same connection twice is no second parent.
    EXPECT_TRUE(import(objects, {link(3, 0), link(4, 0), link(2, 3), link(2, 3), link(1, 2)}).warnings.empty());
}

TEST_P(FbxModelForm, ReadsColoursOfVertices) {
    const auto colors = [](const std::vector<FbxNode>& children) { return node("LayerElementColor", {whole(0)}, children); };
    const FbxNode red = colors({node("MappingInformationType", {text("AllSame")}), node("Colors", {Numbers{1, 0, 0, 1}})});
    Scene scene = import({geometry(1, {red}), model(2, "A")}, {link(2, 0), link(1, 2)});
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.colors.size(), 4 * scene.vertex_count());
    for (size_t i = 0; i < scene.colors.size(); ++i) EXPECT_EQ(scene.colors[i], i % 4 == 0 || i % 4 == 3 ? 1 : 0) << i;
    // In the file's order, one of them twice, one not at all; 0.735357 is half of the light.
    const FbxNode each = colors(
        {node("MappingInformationType", {text("ByPolygonVertex")}), node("ReferenceInformationType", {text("IndexToDirect")}),
         node("Colors", {Numbers{0.735357, 0, 0, 0.5, 0, 1, 0, 1}}), node("ColorIndex", {Indices{0, 1, 1, 0, 1, -1}})});
    scene = import({geometry(1, {each}), model(2, "A")}, {link(2, 0), link(1, 2)});
    ASSERT_EQ(scene.colors.size(), 16u);
    EXPECT_NEAR(scene.colors[0], 0.5, 1e-5);
    EXPECT_EQ(scene.colors[3], 0.5f);
    for (const size_t green : {5u, 9u}) EXPECT_EQ(scene.colors[green], 1) << green;
    for (size_t k = 12; k < 16; ++k) EXPECT_EQ(scene.colors[k], 1) << "there is none";
    scene = import({geometry(1, {colors({node("Name", {text("")})})}), model(2, "A")}, {link(2, 0), link(1, 2)});
    EXPECT_TRUE(scene.colors.empty()) << "an empty layer has no colours";
}

TEST_P(FbxModelForm, TurnsAboutPivotsAndInheritsScaleAsItSays) {
    // Half a turn about (1, 0, 0) takes the square to x 1..2.
    Scene scene =
        import({geometry(1), model(2, "A", {property("RotationPivot", {1, 0, 0}), property("Lcl Rotation", {0, 180, 0})})},
               {link(2, 0), link(1, 2)});
    EXPECT_NEAR(scene.bounds().min[0], 1, 1e-6);
    EXPECT_NEAR(scene.bounds().max[0], 2, 1e-6);
    // Mode 2 leaves the parent's own scale out, but the place of the child is scaled.
    scene = import({geometry(1), model(2, "Parent", {property("Lcl Scaling", {3, 3, 3})}),
                    model(3, "Child", {property("InheritType", {2}), property("Lcl Translation", {1, 0, 0})})},
                   {link(2, 0), link(3, 2), link(1, 3)});
    EXPECT_NEAR(scene.bounds().min[0], 3, 1e-6);
    EXPECT_NEAR(scene.bounds().max[0], 4, 1e-6);
}

TEST_P(FbxModelForm, MapsLayersOfEachKind) {
    const auto layer = [](const std::string& mapping, const std::string& reference, const Numbers& uvs,
                          const Indices& indices) {
        std::vector<FbxNode> children = {node("MappingInformationType", {text(mapping)}),
                                         node("ReferenceInformationType", {text(reference)}), node("UV", {uvs})};
        if (!indices.empty()) children.push_back(node("UVIndex", {indices}));
        return node("LayerElementUV", {whole(0)}, children);
    };
    const auto uvs_of = [&](const FbxNode& uv_layer) {
        const Scene scene = import({geometry(1, {uv_layer}), model(2, "A")}, {link(2, 0), link(1, 2)});
        std::vector<float> out;
        for (const rt_u32 v : scene.triangles) out.push_back(scene.uvs.empty() ? -1 : scene.uvs[2 * size_t(v)]);
        return out;
    };
    const Numbers six = {0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0}, four = {0, 0, 1, 0, 2, 0, 3, 0};
    using Floats = std::vector<float>;
    EXPECT_EQ(uvs_of(layer("ByPolygonVertex", "Direct", six, {})), (Floats{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(uvs_of(layer("ByPolygonVertex", "IndexToDirect", six, {5, 4, 3, 2, 1, 0})), (Floats{5, 4, 3, 2, 1, 0}));
    EXPECT_EQ(uvs_of(layer("ByPolygonVertex", "Index", six, {5, 4, 3, 2, 1, 99})), (Floats{5, 4, 3, 2, 1, 0}));
    EXPECT_EQ(uvs_of(layer("ByVertice", "Direct", four, {})), (Floats{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(uvs_of(layer("ByVertex", "IndexToDirect", four, {3, 2, 1, 0})), (Floats{3, 2, 1, 3, 1, 0}));
    EXPECT_EQ(uvs_of(layer("ByPolygon", "Direct", {7, 0, 8, 0}, {})), (Floats{7, 7, 7, 8, 8, 8}));
    EXPECT_EQ(uvs_of(layer("AllSame", "Direct", {7, 0}, {})), (Floats{7, 7, 7, 7, 7, 7}));
    EXPECT_EQ(uvs_of(layer("ByEdge", "Direct", six, {})), (Floats{-1, -1, -1, -1, -1, -1}));
    EXPECT_EQ(uvs_of(layer("", "", six, {})), (Floats{0, 1, 2, 3, 4, 5}));
}

TEST_P(FbxModelForm, MovesWithItsCurves) {
    constexpr int64_t second = 46186158000;
    const auto curve = [](int64_t id, const std::string& letter) {
        return node("AnimationCurve", {whole(id), text("AnimCurve::"), text("")},
                    {node("KeyTime", {Numbers{0, double(second)}}), node("KeyValueFloat", {Numbers{0, 4}}),
                     node("KeyAttrFlags", {Indices{4}}), node("KeyAttrDataFloat", {Numbers{0, 0, 0, 0}}),
                     node("KeyAttrRefCount", {Indices{2}}),
                     node("Post-Extrapolation", {}, {node("Type", {text(letter)}), node("Repetition", {whole(-1)})})});
    };
    FbxNode stop = node("P", {text("LocalStop"), text("KTime"), text("Time"), text(""), whole(second)});
    const Scene scene = import(
        {geometry(1), model(2, "A", {property("Lcl Translation", {9, 9, 9})}),
         node("AnimationStack", {whole(3), text("AnimStack::Walk"), text("")}, {node("Properties70", {}, {stop})}),
         node("AnimationLayer", {whole(4), text("AnimLayer::Base"), text("")}, {node("Version", {whole(1)})}),
         node("AnimationCurveNode", {whole(5), text("AnimCurveNode::T"), text("")},
              {node("Properties70", {}, {property("d|X", {0}), property("d|Z", {7})})}),
         curve(6, "A"), curve(7, "C")},
        {link(2, 0), link(1, 2), link(4, 3), link(5, 4), link(5, 2, "Lcl Translation"), link(6, 5, "d|X"), link(7, 5, "d|Y")});
    ASSERT_EQ(clips(scene).size(), 1u);
    EXPECT_EQ(clips(scene)[0].name, "Walk");
    EXPECT_NEAR(clips(scene)[0].end_s, 1, 1e-9);
    EXPECT_EQ(clips(scene)[0].fps, 30);
    EXPECT_EQ(scene.bounds().min[2], 9);  // the file at rest
    const auto at = [&](double time) { return posed(scene, evaluate(scene, "", time)).bounds().min; };
    EXPECT_NEAR(at(0.25)[0], 1, 1e-6);
    EXPECT_NEAR(at(0.25)[2], 7, 1e-6);  // a component without a curve has the curve node's value
    EXPECT_NEAR(at(1.5)[0], 6, 1e-6);   // repeated, beginning where it ended
    EXPECT_NEAR(at(1.5)[1], 4, 1e-6);   // held
}

TEST(FbxOldModel, TakesNamesAndBlocksForIds) {
    const Scratch folder;
    const std::string body = "\tVertices: 0,0,0,1,0,0,0,1,0\n\tPolygonVertexIndex: 0,1,-3\n\tGeometryVersion: 124\n";
    const std::string takes =
        "Takes: {\nTake: \"Go\" {\nLocalTime: 0,46186158000\nModel: \"Model::A\" {\nChannel: \"Transform\" {\nChannel: \"T\" "
        "{\n"
        "Channel: \"X\" {\nDefault: 3\nKey: 0,0,L\n,46186158000,2,C,n\n}\n}\n}\n}\n}\n}\n";
    Scene scene = import_file(folder.write(
        "six.fbx",
        "; FBX 6.1.0 project file\nObjects: {\nModel: \"Model::A\", \"Mesh\" {\nProperties60: {\nProperty: \"Lcl Scaling\", "
        "\"Lcl Scaling\", \"A\",2,2,2\n}\n" +
            body +
            "}\n}\nConnections: {\nConnect: \"OO\", \"Model::A\", "
            "\"Model::Scene\"\n}\n" +
            takes));
    EXPECT_NEAR(scene.surface_area(), 2, 1e-6);
    EXPECT_NEAR(posed(scene, evaluate(scene, "Go", 0.5)).bounds().min[0], 1, 1e-6);
    // Up to 5.8 there are no objects and connections; the value at rest is the take's.
    scene = import_file(
        folder.write("five.fbx",
                     "; FBX 5.8.0 project file\nModel: \"Model::Root\" {\nType: \"Null\"\nChildren: \"Model::A\"\n}\n"
                     "Model: \"Model::A\" {\n" +
                         body + "}\n" + takes));
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_NEAR(scene.bounds().min[0], 3, 1e-6);
    EXPECT_EQ(scene.unit_scale, 0.01);
}

// Two nodes of each level have one name, so that a connection may mean either.
TEST(FbxOldModel, RefusesNodesThatMultiplyWithoutEnd) {
    const Scratch folder;
    std::string objects, links;
    for (int i = 1; i <= 40; ++i) {  // each level hangs twice from the level above: 2^40 copies
        const std::string name = "\"Model::N" + std::to_string(i) + "\"";
        const std::string above = i == 1 ? "\"Model::Scene\"" : "\"Model::N" + std::to_string(i - 1) + "\"";
        for (int half = 0; half < 2; ++half) {
            objects += "Model: " + name + ", \"Null\" {\nVersion: 232\n}\n";
            links += "Connect: \"OO\", " + name + ", " + above + "\n";
        }
    }
    expect_error(
        [&] {
            import_file(folder.write(
                "many.fbx", "; FBX 6.1.0 project file\nObjects: {\n" + objects + "}\nConnections: {\n" + links + "}\n"));
        },
        {"too many copies"});
}

}  // namespace
}  // namespace clarity::test
