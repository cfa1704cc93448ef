// fbx_rest_test.cpp -- at rest a scene looks as its FBX file says: bones and the weights of shapes act as they are stored.
#include <gtest/gtest.h>

#include "fbx_model.hpp"
#include "import/import.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

void expect_box(const Scene& scene, const std::array<float, 3>& min, const std::array<float, 3>& max) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(scene.bounds().min[k], min[k], 1e-5) << k;
        EXPECT_NEAR(scene.bounds().max[k], max[k], 1e-5) << k;
    }
}
Numbers columns(double x, double y = 0, double z = 0) {
    return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1};
}

// A unit square whose node stood at x = 10 when it was bound, and a bone at the origin.
class FbxRest : public FbxForms {
 protected:
    std::vector<FbxNode> objects_ = {geometry(1), model(2, "A", {property("Lcl Translation", {10, 0, 0})})};
    std::vector<FbxNode> links_ = {link(2, 0), link(1, 2)};

    void add_skin(const std::vector<FbxNode>& bone, const std::vector<FbxNode>& places,
                  const Indices& vertices = {0, 1, 2, 3}) {
        std::vector<FbxNode> cluster = {node("Indexes", {vertices}), node("Weights", {Numbers(vertices.size(), 1)})};
        cluster.insert(cluster.end(), places.begin(), places.end());
        objects_.push_back(model(3, "Bone", bone));
        objects_.push_back(
            node("Deformer", {whole(10), text("Deformer::Skin"), text("Skin")}, {node("Version", {whole(101)})}));
        objects_.push_back(node("Deformer", {whole(11), text("SubDeformer::Cluster"), text("Cluster")}, cluster));
        links_.insert(links_.end(), {link(3, 0), link(10, 1), link(11, 10), link(3, 11)});
    }
    // A shape that moves all vertices by 2 along y.
    void add_shape(double percent) {
        objects_.push_back(
            node("Deformer", {whole(20), text("Deformer::Shapes"), text("BlendShape")}, {node("Version", {whole(100)})}));
        objects_.push_back(node("Deformer", {whole(21), text("SubDeformer::Lift"), text("BlendShapeChannel")},
                                {node("DeformPercent", {percent}), node("FullWeights", {Numbers{100}})}));
        objects_.push_back(
            node("Geometry", {whole(22), text("Geometry::Lift"), text("Shape")},
                 {node("Indexes", {Indices{0, 1, 2, 3}}), node("Vertices", {Numbers{0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0}})}));
        links_.insert(links_.end(), {link(20, 1), link(21, 20), link(22, 21)});
    }
    Scene at_rest() { return import(objects_, links_); }
    Scene undeformed() {
        at_rest();
        return import_file(folder_.path("model.fbx"), true);
    }
};

TEST_P(FbxRest, BonesActAsTheyAreStored) {
    add_skin({property("Lcl Rotation", {0, 0, 90})}, {node("Transform", {columns(10)}), node("TransformLink", {columns(0)})});
    expect_box(at_rest(), {-1, 10, 0}, {0, 11, 0});
    expect_box(undeformed(), {10, 0, 0}, {11, 1, 0});
    // The node of the mesh has been moved since then; only its place at binding counts.
    objects_[1] = model(2, "A", {property("Lcl Translation", {50, 7, 0}), property("Lcl Scaling", {3, 3, 3})});
    const Scene moved = at_rest();
    expect_box(moved, {-1, 10, 0}, {0, 11, 0});
    EXPECT_TRUE(moved.warnings.empty()) << moved.warnings[0];
    expect_box(posed(moved, evaluate(moved, "", 0)), {-1, 10, 0}, {0, 11, 0});
    // Also below a node that moves it.
    objects_.push_back(model(4, "Above", {property("Lcl Translation", {0, 0, 30})}));
    links_[0] = link(2, 4);
    links_.push_back(link(4, 0));
    expect_box(at_rest(), {-1, 10, 0}, {0, 11, 0});
}

TEST_P(FbxRest, GeometricTransformsComeBeforeTheBinding) {
    objects_[1] = model(2, "A", {property("Lcl Translation", {10, 0, 0}), property("GeometricTranslation", {0, 0, 5})});
    add_skin({property("Lcl Rotation", {0, 0, 90})}, {node("Transform", {columns(10)}), node("TransformLink", {columns(0)})});
    expect_box(at_rest(), {-1, 10, 5}, {0, 11, 5});
}

TEST_P(FbxRest, VerticesWithoutWeightsStayWithTheirNode) {
    add_skin({property("Lcl Translation", {0, 0, 4})}, {node("Transform", {columns(10)}), node("TransformLink", {columns(0)})},
             {2, 3});
    expect_box(at_rest(), {10, 0, 0}, {11, 1, 4});
    objects_[1] = model(2, "A", {property("Lcl Translation", {10, -3, 0})});
    expect_box(at_rest(), {10, -3, 0}, {11, 1, 4});
}

TEST_P(FbxRest, ShapesActWithTheirStoredWeight) {
    add_shape(50);
    expect_box(at_rest(), {10, 1, 0}, {11, 2, 0});
    expect_box(undeformed(), {10, 0, 0}, {11, 1, 0});
}

TEST_P(FbxRest, ShapesComeBeforeTheSkin) {
    add_shape(50);
    add_skin({property("Lcl Rotation", {0, 0, 90})}, {node("Transform", {columns(10)}), node("TransformLink", {columns(0)})});
    expect_box(at_rest(), {-2, 10, 0}, {-1, 11, 0});
}

TEST_P(FbxRest, AnimationsActAtTheirTimesOnly) {
    add_shape(50);
    add_skin({property("Lcl Rotation", {0, 0, 90})}, {node("Transform", {columns(10)}), node("TransformLink", {columns(0)})});
    const auto constant = [](int64_t id, double value) {
        return node("AnimationCurve", {whole(id), text("AnimCurve::"), text("")},
                    {node("KeyTime", {Numbers{0}}), node("KeyValueFloat", {Numbers{value}})});
    };
    const auto curve_node = [](int64_t id) {
        return node("AnimationCurveNode", {whole(id), text("AnimCurveNode::N"), text("")}, {node("Version", {whole(1)})});
    };
    objects_.insert(objects_.end(),
                    {node("AnimationStack", {whole(30), text("AnimStack::Go"), text("")}, {node("Properties70", {})}),
                     node("AnimationLayer", {whole(31), text("AnimLayer::Base"), text("")}, {node("Version", {whole(1)})}),
                     curve_node(32), curve_node(33), constant(34, 0), constant(35, 100)});
    links_.insert(links_.end(), {link(31, 30), link(32, 31), link(33, 31), link(32, 3, "Lcl Rotation"), link(34, 32, "d|Z"),
                                 link(33, 21, "DeformPercent"), link(35, 33, "d|DeformPercent")});
    const Scene scene = at_rest();
    expect_box(scene, {-2, 10, 0}, {-1, 11, 0});
    expect_box(posed(scene, evaluate(scene, "", 0)), {10, 2, 0}, {11, 3, 0});
}

TEST_P(FbxRest, TheBindPoseStandsInForAMissingTransform) {
    add_skin({property("Lcl Rotation", {0, 0, 90})}, {});
    const Scene unknown = at_rest();
    expect_box(unknown, {10, 0, 0}, {11, 1, 0});
    ASSERT_EQ(unknown.warnings.size(), 1u);
    EXPECT_NE(unknown.warnings[0].find("a bone of the skin of 'Square' left out"), std::string::npos) << unknown.warnings[0];
    const auto placed = [](int64_t model, double x) {
        return node("PoseNode", {}, {node("Node", {whole(model)}), node("Matrix", {columns(x)})});
    };
    objects_.push_back(node("Pose", {whole(40), text("Pose::Bind"), text("BindPose")},
                            {node("Type", {text("BindPose")}), placed(2, 12), placed(3, 5)}));
    expect_box(at_rest(), {-1, 7, 0}, {0, 8, 0});
}

INSTANTIATE_TEST_SUITE_P(Forms, FbxRest, kFbxForms, fbx_form_name);

const std::string kTriangle = "Vertices: 0,0,0,1,0,0,0,1,0\nPolygonVertexIndex: 0,1,-3\nGeometryVersion: 124\n";
const std::string kShape = "Shape: \"Lift\" {\nIndexes: 0,1,2\nVertices: 0,2,0,0,2,0,0,2,0\n}\n";
const std::string kPlaces = "Transform: 1,0,0,0,0,1,0,0,0,0,1,0,10,0,0,1\nTransformLink: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n";
const std::string kWeights = "Indexes: 0,1,2\nWeights: 1,1,1\n";

// Clusters, and shapes with the property that has their weight, by names.
TEST(FbxOldRest, ActsAsVersion6Says) {
    const Scratch folder;
    const std::string take =
        "Takes: {\nTake: \"Go\" {\nLocalTime: 0,46186158000\nModel: \"Model::A\" {\nChannel: \"Lift\" {\n"
        "Key: 0,100,L,46186158000,100,L\n}\n}\n}\n}\n";
    const std::string path = folder.write(
        "six.fbx",
        "; FBX 6.1.0 project file\nObjects: {\nModel: \"Model::A\", \"Mesh\" {\nProperties60: {\n"
        "Property: \"Lcl Translation\", \"Lcl Translation\", \"A\",77,0,0\nProperty: \"Lift\", \"Number\", \"A+N\",50\n}\n" +
            kTriangle + kShape +
            "}\nModel: \"Model::Bone\", \"Limb\" {\nProperties60: {\n"
            "Property: \"Lcl Rotation\", \"Lcl Rotation\", \"A\",0,0,90\n}\n}\n"
            "Deformer: \"Deformer::Skin A\", \"Skin\" {\nVersion: 100\n}\n"
            "Deformer: \"SubDeformer::Cluster Bone\", \"Cluster\" {\n" +
            kWeights + kPlaces +
            "}\n}\nConnections: {\nConnect: \"OO\", \"Model::A\", \"Model::Scene\"\n"
            "Connect: \"OO\", \"Model::Bone\", \"Model::Scene\"\nConnect: \"OO\", \"Deformer::Skin A\", \"Model::A\"\n"
            "Connect: \"OO\", \"SubDeformer::Cluster Bone\", \"Deformer::Skin A\"\n"
            "Connect: \"OO\", \"Model::Bone\", \"SubDeformer::Cluster Bone\"\n}\n" +
            take);
    const Scene scene = import_file(path);
    expect_box(scene, {-2, 10, 0}, {-1, 11, 0});
    expect_box(posed(scene, evaluate(scene, "", 0.5)), {-3, 10, 0}, {-2, 11, 0});
    expect_box(import_file(path, true), {77, 0, 0}, {78, 1, 0});
}

// Skins are in the model, and channels have the weights of shapes.
TEST(FbxOldRest, ActsAsVersion5Says) {
    const Scratch folder;
    const std::string bone =
        "Model: \"Model::Bone\" {\nType: \"Limb\"\nChannel: \"Transform\" {\nChannel: \"R\" {\nChannel: \"Z\" {\nDefault: "
        "90\n}\n}\n}\n}\n";
    const std::string weight = "Channel: \"Lift (Shape)\" {\nDefault: 50\n}\n";
    const auto take = [](const std::string& channel) {
        return "Takes: {\nCurrent: \"Go\"\nTake: \"Go\" {\nLocalTime: 0,46186158000\nModel: \"Model::A\" {\n" + channel +
               "}\n}\n}\n";
    };
    const auto five = [&](const std::string& in_model, const std::string& takes) {
        return import_file(folder.write("five.fbx",
                                        "; FBX 5.8.0 project file\nModel: \"Model::Root\" {\nType: \"Null\"\n"
                                        "Children: \"Model::A\",\"Model::Bone\"\n}\nModel: \"Model::A\" {\n" +
                                            kTriangle + kShape + "Link: \"Model::Bone\" {\n" + kWeights + kPlaces + "}\n" +
                                            in_model + "}\n" + bone + takes));
    };
    expect_box(five(weight, ""), {-2, 10, 0}, {-1, 11, 0});
    expect_box(five("", take(weight)), {-2, 10, 0}, {-1, 11, 0});
    expect_box(five("Channel: \"Lift\" {\nDefault: 50\n}\n", ""), {-2, 10, 0}, {-1, 11, 0});  // without 3ds Max's ending
    const Scene moving =
        five("", take("Channel: \"Lift (Shape)\" {\nDefault: 50\nKeyVer: 4002\nKey: 0,100,U,s,0,0,n,46186158000,100,L\n}\n"));
    expect_box(moving, {-2, 10, 0}, {-1, 11, 0});
    expect_box(posed(moving, evaluate(moving, "Go", 0.5)), {-3, 10, 0}, {-2, 11, 0});
}

// Version 7.1 has ids and connections, and still shapes within the geometry, whose properties have their weights.
TEST(FbxOldRest, ActsAsVersion71Says) {
    const Scratch folder;
    const std::string path =
        folder.write("seven.fbx",
                     "; FBX 7.1.0 project file\nObjects: {\nGeometry: 1, \"Geometry::\", \"Mesh\" {\nProperties70: {\n"
                     "P: \"Lift\", \"Number\", \"\", \"A+\",50\n}\nVertices: *9 {\na: 0,0,0,1,0,0,0,1,0\n}\n"
                     "PolygonVertexIndex: *3 {\na: 0,1,-3\n}\nShape: \"Lift\" {\nIndexes: *3 {\na: 0,1,2\n}\nVertices: *9 {\n"
                     "a: 0,2,0,0,2,0,0,2,0\n}\n}\n}\nModel: 2, \"Model::A\", \"Mesh\" {\nVersion: 232\n}\n"
                     "AnimationStack: 3, \"AnimStack::Go\", \"\" {\n}\nAnimationLayer: 4, \"AnimLayer::B\", \"\" {\n}\n"
                     "AnimationCurveNode: 5, \"AnimCurveNode::Lift\", \"\" {\n}\nAnimationCurve: 6, \"AnimCurve::\", \"\" {\n"
                     "KeyTime: *1 {\na: 0\n}\nKeyValueFloat: *1 {\na: 100\n}\n}\n}\n"
                     "Connections: {\nC: \"OO\",2,0\nC: \"OO\",1,2\nC: \"OO\",4,3\nC: \"OO\",5,4\nC: \"OP\",5,1,\"Lift\"\n"
                     "C: \"OP\",6,5,\"d|Lift\"\n}\n");
    const Scene scene = import_file(path);
    expect_box(scene, {0, 1, 0}, {1, 2, 0});
    expect_box(posed(scene, evaluate(scene, "Go", 0.5)), {0, 2, 0}, {1, 3, 0});
    expect_box(import_file(path, true), {0, 0, 0}, {1, 1, 0});
}

// Vertices of FBX files far from 0, as surveys in UTM have them, keep their shape.

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
