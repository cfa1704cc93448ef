// What importers deliver of motion, good and bad, with both kinds of import: in this process and in the worker.
#include "import/import.hpp"
#include "import_case.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {
namespace {

class MotionSink : public ImportCase, public ::testing::WithParamInterface<bool> {
 protected:
    void SetUp() override {
        ImportCase::SetUp();
        options_.in_process = GetParam();
    }
    std::array<float, 3> corner(const Scene& scene, int number, double time_s, size_t instance = 0) const {
        const Scene at = posed(scene, evaluate(scene, "", time_s));
        return transform_point(at.instances.at(instance).world_from_object, &at.positions[3 * number]);
    }
};
INSTANTIATE_TEST_SUITE_P(Ways, MotionSink, ::testing::Bool(),
                         [](const auto& way) { return way.param ? std::string("in_process") : std::string("in_worker"); });

TEST_P(MotionSink, everything_arrives) {
    const Scene scene = import_text("moving");
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    const std::vector<ClipInfo> infos = clips(scene);
    ASSERT_EQ(infos.size(), 1u);
    EXPECT_EQ(infos[0].name, "walk");
    EXPECT_EQ(infos[0].begin_s, 1);
    EXPECT_EQ(infos[0].end_s, 3);
    EXPECT_EQ(infos[0].fps, 25);
    EXPECT_EQ(infos[0].nodes, 1u);
    EXPECT_EQ(infos[0].morphs, 1u);
    EXPECT_EQ(infos[0].skins, 1u);
    EXPECT_NEAR(corner(scene, 0, 2)[0], 5, 1e-5) << "the bone follows its parent";
    const auto last = corner(scene, 2, 3);
    EXPECT_NEAR(last[0], 10, 1e-5) << "a vertex without weights stays with its node";
    EXPECT_NEAR(last[1], 2, 1e-5) << "vertex frames";
    EXPECT_NEAR(last[2], 1, 1e-5) << "the morph";
}

TEST_P(MotionSink, a_file_that_moves_can_be_placed_twice) {
    file("inner.cltest", "moving");
    const Scene scene = import_text("load inner.cltest 1 0\nload inner.cltest 2 100");
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.motion.skins.size(), 1u);
    EXPECT_NEAR(corner(scene, 0, 2, 0)[0], 5, 1e-4);
    EXPECT_NEAR(corner(scene, 0, 2, 1)[0], 110, 1e-4) << "twice as large, at 100";
}

// Files 2, 4 and 8 of a sequence: at n / 24 seconds each looks as it is, and in between vertices move straight.
TEST_P(MotionSink, numbered_files_are_a_clip) {
    for (const int number : {2, 4, 8}) {
        const std::string x = std::to_string(number);
        file("walk_0" + x + ".cltest", "face " + x + " 0 9 0 9 1");
    }
    const Scene scene = import({path("walk_##.cltest")});
    const std::vector<ClipInfo> infos = clips(scene);
    ASSERT_EQ(infos.size(), 1u);
    EXPECT_EQ(infos[0].name, "walk_##.cltest");
    EXPECT_NEAR(infos[0].begin_s, 2 / 24.0, 1e-12);
    EXPECT_NEAR(infos[0].end_s, 8 / 24.0, 1e-12);
    SequenceReader reader(plugins(), options_, progress_);
    const auto x_at = [&](double number) {
        const Scene at = posed(scene, evaluate(scene, "", number / 24, std::ref(reader)));
        return at.positions[0];
    };
    EXPECT_NEAR(x_at(2), 2, 1e-5);
    EXPECT_NEAR(x_at(3), 3, 1e-5);
    EXPECT_NEAR(x_at(5), 5, 1e-5);
    EXPECT_NEAR(x_at(99), 8, 1e-5);
    EXPECT_NEAR(x_at(-1), 2, 1e-5);
    file("walk_08.cltest", "face 0 0 1 0 1 1 0 1");
    SequenceReader again(plugins(), options_, progress_);
    try {
        evaluate(scene, "", 8 / 24.0, std::ref(again));
        FAIL();
    } catch (const Error& e) {
        EXPECT_TRUE(contains(e.what(), "walk_08.cltest: has 4 vertices, but the first file of the sequence has 3")) << e.what();
    }
    EXPECT_TRUE(contains(failure({path("run_##.cltest")}), "no file has such a name"));
}

// A text file may load a sequence, too.
TEST_P(MotionSink, a_sequence_may_be_loaded) {
    file("walk_1.cltest", "face 1 0 9 0 9 1");
    file("walk_2.cltest", "face 2 0 9 0 9 1");
    const Scene scene = import_text("load walk_#.cltest 1 100");
    SequenceReader reader(plugins(), options_, progress_);
    const Scene at = posed(scene, evaluate(scene, "", 2 / 24.0, std::ref(reader)));
    EXPECT_NEAR(transform_point(at.instances.at(0).world_from_object, at.positions.data())[0], 102, 1e-4);
}

TEST_P(MotionSink, bugs_of_plugins_are_refused) {
    const std::pair<const char*, const char*> bugs[] = {{"parent", "node id 9 of 0"},
                                                        {"order", "rotation_order 77"},
                                                        {"span", "RT_SPAN_"},
                                                        {"clip id", "clip id 0 of 1"},
                                                        {"layer", "layer 1"},
                                                        {"moves", "moves 99"},
                                                        {"target", "node id 40 of 2"},
                                                        {"component", "component 7"},
                                                        {"no keys", "no keys"},
                                                        {"quaternion", "RT_ROTATE_QUATERNION"},
                                                        {"bone node", "node id 9"},
                                                        {"bone", "bone 5 of 1"},
                                                        {"skin bytes", "rt_skin_desc"},
                                                        {"skin mesh", "mesh id 4 of 1"},
                                                        {"two skins", "has one already"},
                                                        {"instance node", "node id 9 of 2"},
                                                        {"unhung", "rt_instance_desc::node"}};
    for (const auto& [bug, expected] : bugs)
        EXPECT_TRUE(contains(failure_of_text(std::string("moving ") + bug), expected)) << bug;
}

TEST_P(MotionSink, damage_of_files_is_left_out_with_a_warning) {
    const std::pair<const char*, const char*> damages[] = {
        {"node nan", "2 nodes have transforms"}, {"key nan", "2 channels of keys"},    {"key order", "2 channels of keys"},
        {"weight vertex", "1 weights or bones"}, {"weight nan", "1 weights or bones"}, {"morph nan", "1 targets of morphs"},
        {"morph vertex", "1 targets of morphs"}, {"frame order", "1 geometry caches"}};
    for (const auto& [damage, expected] : damages) {
        const Scene scene = import_text(std::string("moving ") + damage);
        ASSERT_EQ(scene.warnings.size(), 1u) << damage;
        EXPECT_TRUE(contains(scene.warnings[0], expected)) << damage;
        EXPECT_EQ(validate(scene), "");
        corner(scene, 0, 2);
    }
}

}  // namespace
}  // namespace clarity
