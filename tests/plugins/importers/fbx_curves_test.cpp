// fbx_curves_test.cpp -- keys of FBX files: tangents of each kind, how curves go on outside of their keys, keys of old takes.
#include <gtest/gtest.h>

#include <cstring>

#include "fbx_model.hpp"
#include "import/import.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

constexpr int32_t kAutomatic = 0x108, kTcb = 0x208, kUser = 0x408, kTimeIndependent = 0x2000, kProgressive = 0x4000;

struct Keys {
    Numbers times, values;  // in seconds
    Indices flags;
    Numbers data;  // four for each of the flags
    std::string before = "C", after = "C";
    int64_t before_count = -1, after_count = -1;
};

class FbxCurves : public FbxForms {
 protected:
    // From version 7.2 on, ASCII files have the bits of the floats.
    static FbxNode data(const Numbers& numbers) {
        if (GetParam().binary) return node("KeyAttrDataFloat", {numbers});
        Indices bits;
        for (const double x : numbers) {
            const float number = static_cast<float>(x);
            bits.push_back(0);
            std::memcpy(&bits.back(), &number, 4);
        }
        return node("KeyAttrDataFloat", {bits});
    }
    static FbxNode outside(const std::string& name, const std::string& letter, int64_t count) {
        return node(name, {}, {node("Type", {text(letter)}), node("Repetition", {whole(count)})});
    }
    // A square that keys move along x.
    Scene moved(const Keys& keys) {
        Numbers times;
        for (const double t : keys.times) times.push_back(t * 46186158000);
        const FbxNode curve =
            node("AnimationCurve", {whole(6), text("AnimCurve::"), text("")},
                 {node("KeyTime", {times}), node("KeyValueFloat", {keys.values}), node("KeyAttrFlags", {keys.flags}),
                  data(keys.data), node("KeyAttrRefCount", {Indices(keys.flags.size(), 1)}),
                  outside("Pre-Extrapolation", keys.before, keys.before_count),
                  outside("Post-Extrapolation", keys.after, keys.after_count)});
        return import(
            {geometry(1), model(2, "A", {property("Lcl Translation", {9, 0, 0})}),
             node("AnimationStack", {whole(3), text("AnimStack::Walk"), text("")}, {node("Properties70", {})}),
             node("AnimationLayer", {whole(4), text("AnimLayer::Base"), text("")}, {node("Version", {whole(1)})}),
             node("AnimationCurveNode", {whole(5), text("AnimCurveNode::T"), text("")}, {node("Version", {whole(1)})}), curve},
            {link(2, 0), link(1, 2), link(4, 3), link(5, 4), link(5, 2, "Lcl Translation"), link(6, 5, "d|X")});
    }
};
double x_at(const Scene& scene, double time) {
    return posed(scene, evaluate(scene, "", time)).bounds().min[0];
}

TEST_P(FbxCurves, TcbKeysBendAsKochanekAndBartelsSay) {
    // The lines rise by 4 and fall by 1 a second. The middle key has slopes of -0.09375 and 0.34375.
    const Scene scene = moved({{0, 1, 3}, {0, 4, 2}, {kTcb, kTcb, kTcb}, {0, 0, 0, 0, 0.5, 0.25, -0.5, 0, 0, 0, 0, 0}});
    EXPECT_NEAR(x_at(scene, 0.5), 2 + 0.125 * (4 + 0.09375), 1e-5);
    EXPECT_NEAR(x_at(scene, 2), 3 + 0.25 * (0.34375 + 1), 1e-5);
    // Full tension: no slopes. The next key's own slope is unknown then.
    const Scene tense = moved({{0, 1}, {0, 4}, {kTcb, kUser}, {1, 0, 0, 0, 7, 0, 0, 0}});
    EXPECT_NEAR(x_at(tense, 0.5), 2, 1e-5);
    EXPECT_NEAR(x_at(tense, 0.25), 4 * (3 * 0.0625 - 2 * 0.015625), 1e-5);
}

TEST_P(FbxCurves, UserKeysHaveTheirSlopes) {
    const Scene scene = moved({{0, 1}, {0, 4}, {kUser, kUser}, {2.5, -1.5, 0, 0, 0, 0, 0, 0}});
    EXPECT_NEAR(x_at(scene, 0.5), 2 + 0.125 * (2.5 + 1.5), 1e-5);
}

TEST_P(FbxCurves, AutomaticKeysFollowTheirNeighbours) {
    const auto at = [&](int32_t flags, double lean, double time) {
        const int32_t each = kAutomatic | flags;
        return x_at(moved({{0, 1, 3}, {0, 4, 2}, {each, each, each}, {0, 0, 0, 0, lean, 0, 0, 0, 0, 0, 0, 0}}), time);
    };
    const auto middle = [](double left, double right) { return 3 + 0.25 * (left - right); };  // of the second span
    EXPECT_NEAR(at(kTimeIndependent, 0, 2), middle(2. / 3, -1), 1e-5);
    const double slope = 0.5 * (2. / 3 + 4 * (2. / 3) - 1. / 3);  // half of that, half of a parabola's
    EXPECT_NEAR(at(0, 0, 2), middle(slope, -1), 1e-5);
    EXPECT_NEAR(at(0, 50, 2), middle(0.5 * (slope - 1), -1), 1e-5) << "it leans towards the next key";
    EXPECT_NEAR(at(kProgressive, 0, 2), 3, 1e-5) << "flat at peaks, and at the last key";
    EXPECT_NEAR(at(kProgressive, 0, 0.5), 2, 1e-5);
}

TEST_P(FbxCurves, GoesOnOutsideOfTheKeys) {
    const auto scene = [&](const std::string& before, int64_t before_count, const std::string& after, int64_t after_count) {
        return moved({{0, 1}, {0, 4}, {0x4, 0x4}, Numbers(8, 0), before, after, before_count, after_count});
    };
    const Scene mirrored = scene("M", 1, "M", 2);
    EXPECT_NEAR(x_at(mirrored, 1.25), 3, 1e-5);
    EXPECT_NEAR(x_at(mirrored, 2.25), 1, 1e-5);
    EXPECT_NEAR(x_at(mirrored, 9), 4, 1e-5) << "the second mirrored repetition ends where the keys do";
    EXPECT_NEAR(x_at(mirrored, -0.25), 1, 1e-5);
    EXPECT_NEAR(x_at(mirrored, -9), 4, 1e-5);
    const Scene once = scene("R", 2, "M", 1);
    EXPECT_NEAR(x_at(once, 9), 0, 1e-5);
    EXPECT_NEAR(x_at(once, -0.25), 3, 1e-5);
    EXPECT_NEAR(x_at(once, -9), 0, 1e-5);
    const Scene sloped = scene("K", 0, "K", 0);
    EXPECT_NEAR(x_at(sloped, 3), 12, 1e-5) << "a count means nothing to a slope";
    EXPECT_NEAR(x_at(sloped, -1), -4, 1e-5);
    EXPECT_NEAR(x_at(scene("R", 0, "M", 0), 3), 4, 1e-5) << "no repetition";
}

TEST_P(FbxCurves, ABrokenCurveCostsItself) {
    const Scene scene = moved({{1, 0}, {0, 4}, {0x4, 0x4}, Numbers(8, 0)});
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(x_at(scene, 0.5), 9);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("a curve of an animation is left out"), std::string::npos) << scene.warnings[0];
    EXPECT_NE(scene.warnings[0].find("order of their times"), std::string::npos) << scene.warnings[0];
}

TEST_P(FbxCurves, StacksWithoutPropertiesHaveTheRangeOfTheirTake) {
    const auto stack = [](int64_t id, const std::string& name, const std::vector<FbxNode>& properties) {
        return node("AnimationStack", {whole(id), text("AnimStack::" + name), text("")},
                    {node("Properties70", {}, properties)});
    };
    const auto take = [](const std::string& name, const std::string& kind) {
        return node("Take", {text(name)}, {node(kind, {whole(46186158000), whole(3 * 46186158000)})});
    };
    const auto local_stop = [](int64_t ticks) {
        return node("P", {text("LocalStop"), text("KTime"), text("Time"), text(""), whole(ticks)});
    };
    const FbxNode stop = local_stop(46186158000), none = local_stop(0);
    const Scene scene = import_file(folder_.write(
        "takes.fbx",
        FbxWriter(GetParam())
            .file(
                {node("FBXHeaderExtension", {}, {node("FBXVersion", {whole(GetParam().version)})}),
                 node("Definitions", {},
                      {node("ObjectType", {text("AnimationStack")},
                            {node("PropertyTemplate", {text("FbxAnimStack")}, {node("Properties70", {}, {none})})})}),
                 node("Objects", {},
                      {geometry(1), model(2, "A"), stack(3, "Own", {stop}), stack(4, "Local", {}), stack(5, "Reference", {})}),
                 node("Connections", {}, {link(2, 0), link(1, 2)}),
                 node("Takes", {},
                      {take("Own", "LocalTime"), take("Local", "LocalTime"), take("Reference", "ReferenceTime")})})));
    const std::vector<ClipInfo> infos = clips(scene);
    ASSERT_EQ(infos.size(), 3u);
    EXPECT_NEAR(infos[0].end_s, 1, 1e-9);
    for (const size_t i : {1u, 2u}) {
        EXPECT_NEAR(infos[i].begin_s, 1, 1e-9) << infos[i].name;
        EXPECT_NEAR(infos[i].end_s, 3, 1e-9) << infos[i].name;
    }
}

INSTANTIATE_TEST_SUITE_P(Forms, FbxCurves, kFbxForms, fbx_form_name);

// A square of version 6.1 that a channel of a take moves along x.
Scene with_channel(const std::string& channel) {
    const Scratch folder;
    return import_file(folder.write("six.fbx",
                                    "; FBX 6.1.0 project file\nObjects: {\nModel: \"Model::A\", \"Mesh\" {\n"
                                    "Vertices: 0,0,0,1,0,0,0,1,0\nPolygonVertexIndex: 0,1,-3\nGeometryVersion: 124\n}\n}\n"
                                    "Connections: {\nConnect: \"OO\", \"Model::A\", \"Model::Scene\"\n}\n"
                                    "Takes: {\nTake: \"Go\" {\nLocalTime: 0,46186158000\nModel: \"Model::A\" {\nChannel: "
                                    "\"Transform\" {\nChannel: \"T\" {\n"
                                    "Channel: \"X\" {\n" +
                                        channel + "\n}\n}\n}\n}\n}\n}\n"));
}

TEST(FbxTakeCurves, GoOnOutsideOfTheirKeys) {
    const Scene scene = with_channel(
        "Key: 0,0,L,46186158000,4,L\nPre-Extrapolation: {\nType: M\nRepetition: 1\n}\n"
        "Post-Extrapolation: {\nType: R\nRepetition: 2\n}");
    EXPECT_NEAR(x_at(scene, 0.5), 2, 1e-5);
    EXPECT_NEAR(x_at(scene, 1.25), 1, 1e-5);
    EXPECT_NEAR(x_at(scene, 9), 4, 1e-5);
    EXPECT_NEAR(x_at(scene, -0.25), 1, 1e-5);
    EXPECT_NEAR(x_at(scene, -9), 4, 1e-5);
}

TEST(FbxTakeCurves, HaveTangentsOfEachKind) {
    // Each first key is followed by another, which is found only if the first one was read to its end.
    const char* const lines[] = {"U,s,4,4,n,46186158000,4,U,s,0,0,n", "U,b,4,4,a,0.333333,0.333333,46186158000,4,L",
                                 "U,t,0,0,4.099946e-31,46186158000,4,U,t,0,0,4.099946e-31", "L,46186158000,4,C,n"};
    for (const char* const keys : lines)
        EXPECT_NEAR(x_at(with_channel(std::string("Key: 0,0,") + keys), 0.25), 1, 1e-4) << keys;
    const double flat = 4 * (3 * 0.0625 - 2 * 0.015625);  // no slopes at either end
    const char* const flat_lines[] = {"U,a,n,46186158000,4,U,a,n", "U,p,1,1,n,n,46186158000,4,U,p,1,1,a,0.333333,0.333333,n",
                                      "U,q,1,1,d,d,46186158000,4,U,q,1,1,n,n", "U,d,1,n,46186158000,4,U,d,1,n",
                                      "U,t,1,0,0,46186158000,4,U,t,1,0,0"};
    for (const char* const keys : flat_lines)
        EXPECT_NEAR(x_at(with_channel(std::string("Key: 0,0,") + keys), 0.25), flat, 1e-4) << keys;
    // Before KeyVer 4005 some letters are missing.
    const char* const old[] = {"KeyVer: 4003\nKey: 0,0,U,s,0,0,46186158000,4,C", "KeyVer: 4004\nKey: 0,0,U,a,46186158000,4,U,a",
                               "KeyVer: 4004\nKey: 0,0,U,p,1,1,n,46186158000,4,U,p,1,1,n"};
    for (const char* const channel : old) EXPECT_NEAR(x_at(with_channel(channel), 0.25), flat, 1e-4) << channel;
}

TEST(FbxTakeCurves, UnknownKeysCostTheirCurve) {
    for (const char* const keys : {"Key: 0,2,Z,46186158000,4,L", "Key: 0,2,U,z,1,1,n,46186158000,4,L"}) {
        const Scene scene = with_channel(keys);
        EXPECT_EQ(x_at(scene, 0.5), 0) << keys;
        ASSERT_EQ(scene.warnings.size(), 1u) << keys;
        EXPECT_NE(scene.warnings[0].find("line 19: key 1 "), std::string::npos) << scene.warnings[0];
    }
}

}  // namespace
}  // namespace clarity::test
