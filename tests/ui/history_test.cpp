// Undo and redo: each gesture is one step, not each frame; camera motion is no step.
#include "ui/session/history.hpp"

#include <gtest/gtest.h>

#include "ui/session/playback.hpp"
#include "ui/viewport/timeline.hpp"

namespace clarity::ui {
namespace {

TEST(History, UndoesAndRedoes) {
    History history;
    DesiredState desired;
    desired.main.settings.accel = "bvh8";
    history.observe(desired, false);
    EXPECT_FALSE(history.can_undo());
    desired.main.settings.depth = 3;
    history.observe(desired, false);
    desired.main.settings.accel = "spheres";
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Structure");
    history.undo(desired);
    EXPECT_EQ(desired.main.settings.accel, "bvh8");
    EXPECT_EQ(desired.main.settings.depth, 3);
    EXPECT_EQ(history.undo_name(), "Depth");
    EXPECT_EQ(history.redo_name(), "Structure");
    history.undo(desired);
    EXPECT_EQ(desired.main.settings.depth, Settings().depth);
    EXPECT_FALSE(history.can_undo());
    history.undo(desired);  // nothing happens
    history.redo(desired);
    history.redo(desired);
    EXPECT_EQ(desired.main.settings.accel, "spheres");
    EXPECT_FALSE(history.can_redo());
}

TEST(History, AGestureIsOneStep) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    for (int depth = 1; depth <= 16; ++depth) {
        desired.main.settings.depth = depth;
        history.observe(desired, true);
    }
    EXPECT_FALSE(history.can_undo());
    history.observe(desired, false);
    history.undo(desired);
    EXPECT_EQ(desired.main.settings.depth, Settings().depth);
    EXPECT_FALSE(history.can_undo());
}

TEST(History, UndoDuringAGestureUndoesAllOfIt) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.background = {1, 0, 0};
    history.observe(desired, true);
    history.undo(desired);
    EXPECT_EQ(desired.background, DesiredState().background);
    history.redo(desired);
    EXPECT_EQ(desired.background[0], 1);
}

TEST(History, UndoDoesNotMoveTheCamera) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.instances.hidden = {4};
    history.observe(desired, false);
    desired.camera.eye = {1, 2, 3};
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Visibility");
    history.undo(desired);
    EXPECT_TRUE(desired.instances.hidden.empty());
    EXPECT_EQ(desired.camera.eye[2], 3);
}

TEST(History, AMaskIsAStep) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.instances.set_mask(4, RT_SEEN_BY_ALL & ~RT_SEEN_BY_CAMERA);
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Mask");
    history.undo(desired);
    EXPECT_TRUE(desired.instances.empty());
}

TEST(History, ANewChangeDiscardsRedo) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.main.settings.depth = 2;
    history.observe(desired, false);
    history.undo(desired);
    desired.main.settings.spp = 9;
    history.observe(desired, false);
    EXPECT_FALSE(history.can_redo());
    EXPECT_EQ(history.undo_name(), "Samples");
    history.forget();
    EXPECT_FALSE(history.can_undo());
}

TEST(History, NamesWhatDiffers) {
    DesiredState a, b;
    EXPECT_EQ(difference_name(a, b), "");
    b.camera.eye = {9, 9, 9};
    EXPECT_EQ(difference_name(a, b), "");
    b.other = b.main;
    EXPECT_EQ(difference_name(a, b), "Comparison");
    a.other = a.main;
    b.other->settings.depth = 1;
    EXPECT_EQ(difference_name(a, b), "B: Depth");
    b.lights.push_back({"lamp", {}, true});
    b.ambient = {1, 1, 1};
    EXPECT_EQ(difference_name(a, b), "3 changes");
    a.lights = b.lights;
    a.lights[0].on = false;
    a.ambient = b.ambient;
    a.other = b.other;
    EXPECT_EQ(difference_name(a, b), "lamp");
}

// // The timeline's clock and scale, and the lights that follow a pose. No screen is needed.

class PlaybackTest : public ::testing::Test {
 protected:
    PlaybackTest() {
        scene_.motion.clips = {{"walk", 0, 0, 0, 0, 2, 24}, {"run", 0, 0, 0, 1, 1.5, 30}};
        playback_.open(scene_, desired_);
    }
    Scene scene_;
    Playback playback_;
    DesiredState desired_;
};

TEST_F(PlaybackTest, FollowsTheRealClockInItsLoop) {
    EXPECT_FALSE(desired_.pose.time_s);
    EXPECT_EQ(desired_.pose.clip, "walk");
    playback_.set_loop(desired_, 0.5, 1.5);
    desired_.speed = 2;
    playback_.play(desired_);
    EXPECT_EQ(desired_.pose.time_s, 0.5);
    playback_.advance(desired_, 100);
    EXPECT_EQ(desired_.pose.time_s, 0.5) << "the first call only starts the clock";
    playback_.advance(desired_, 100.25);
    EXPECT_DOUBLE_EQ(*desired_.pose.time_s, 1);
    playback_.advance(desired_, 100.625);  // 1.75 s, beyond the end of the loop
    EXPECT_DOUBLE_EQ(*desired_.pose.time_s, 0.75);
    playback_.advance(desired_, 107.625);  // seven times round and then seven more
    EXPECT_NEAR(*desired_.pose.time_s, 0.75, 1e-9);
    playback_.hold(true);
    playback_.advance(desired_, 108);
    EXPECT_NEAR(*desired_.pose.time_s, 0.75, 1e-9);
    playback_.hold(false);
    playback_.advance(desired_, 108.01);
    playback_.pause(desired_);
    EXPECT_EQ(desired_.pose.time_s, 18.0 / 24);
    playback_.advance(desired_, 109);
    EXPECT_EQ(desired_.pose.time_s, 18.0 / 24);
}

TEST_F(PlaybackTest, StepsWithinTheLoop) {
    playback_.step(desired_, 1);
    EXPECT_EQ(desired_.pose.time_s, 0.0);
    playback_.step(desired_, -1);
    EXPECT_EQ(desired_.pose.time_s, 2.0);
    playback_.set_loop(desired_, 0.5, 1);
    playback_.step(desired_, -1);  // outside of the loop: a step in the clip
    EXPECT_EQ(desired_.pose.time_s, 47.0 / 24);
    playback_.show(desired_, 0.99);
    EXPECT_EQ(desired_.pose.time_s, 1.0);
    playback_.step(desired_, 1);
    EXPECT_EQ(desired_.pose.time_s, 0.5);
    playback_.step(desired_, -1);
    EXPECT_EQ(desired_.pose.time_s, 1.0);
    playback_.show(desired_, 77);
    EXPECT_EQ(desired_.pose.time_s, 2.0);
}

TEST_F(PlaybackTest, ALoopIsAtLeastAFrame) {
    playback_.set_loop(desired_, 1.9, 1.9);
    EXPECT_NEAR(desired_.loop[1] - desired_.loop[0], 1.0 / 24, 1e-9);
    playback_.set_loop(desired_, 5, -5);
    EXPECT_LE(desired_.loop[1], 2);
    EXPECT_GT(desired_.loop[1], desired_.loop[0]);
    playback_.choose(desired_, "run");
    EXPECT_EQ(desired_.loop, (std::array<double, 2>{1, 1.5}));
    EXPECT_EQ(desired_.pose.time_s, 1.0);
    playback_.choose(desired_, "fly");
    EXPECT_EQ(desired_.pose.clip, "run");
}

// A clip that is shorter than a frame, one that ends before it begins, times beyond all numbers of frames.
TEST_F(PlaybackTest, OddClips) {
    for (const Clip& clip :
         {Clip{"short", 0, 0, 0, 0.01, 0.02, 24}, Clip{"empty", 0, 0, 0, 3, 3, 0}, Clip{"far", 0, 0, 0, -1e300, 1e300, 1e6}}) {
        scene_.motion.clips = {clip};
        playback_.open(scene_, desired_);
        playback_.step(desired_, 1);
        playback_.step(desired_, 1);
        playback_.step(desired_, -1);
        playback_.set_loop(desired_, 1, 2);
        playback_.play(desired_);
        playback_.advance(desired_, 1);
        playback_.advance(desired_, 2);
        playback_.pause(desired_);
        ASSERT_TRUE(desired_.pose.time_s) << clip.name;
        EXPECT_TRUE(std::isfinite(*desired_.pose.time_s)) << clip.name;
        EXPECT_LE(desired_.loop[0], desired_.loop[1]) << clip.name;
    }
    scene_.motion.clips.clear();
    playback_.open(scene_, desired_);
    EXPECT_FALSE(playback_.any());
    playback_.play(desired_);
    playback_.step(desired_, 1);
    playback_.advance(desired_, 3);
    EXPECT_FALSE(desired_.pose.time_s);
}

TEST(TimelineScale, MarksFramesThatHaveRoom) {
    const TimelineScale scale{0, 2, 10, 210};
    EXPECT_EQ(scale.place_of(1), 110);
    EXPECT_EQ(scale.time_at(110), 1);
    EXPECT_EQ(scale.time_at(-5), 0);
    EXPECT_EQ(scale.time_at(999), 2);
    EXPECT_EQ(mark_step(scale, 24, 4), 1);
    EXPECT_EQ(mark_step(scale, 24, 40), 10);
    EXPECT_EQ(marked_frames(scale, 24, 10), (std::vector<long>{0, 10, 20, 30, 40}));
    EXPECT_EQ(marked_frames({1.0 / 24, 0.5, 0, 100}, 24, 5), (std::vector<long>{5, 10}));
    EXPECT_LE(marked_frames({-1e300, 1e300, 0, 100}, 24, 1).size(), 1000u);
}

// The clip is a step, the time within it is not. Lights that follow the file are none either, in no earlier step.
TEST(HistoryOfTime, KeepsTheTimeAndTheLights) {
    const auto lights = [](float x) {
        Light light;
        light.values.position[0] = x;
        return std::vector<Light>{light};
    };
    History history;
    DesiredState desired;
    desired.pose.clip = "walk";
    desired.lights.push_back({"lamp", lights(0).front().values, true});
    history.observe(desired, false);
    desired.pose.time_s = 1.5;
    follow_lights(desired, lights(0), lights(3));
    history.lights_moved(lights(0), lights(3));
    EXPECT_EQ(desired.lights[0].values.position[0], 3);
    history.observe(desired, false);
    EXPECT_FALSE(history.can_undo());
    desired.speed = 2;
    history.observe(desired, false);
    follow_lights(desired, lights(3), lights(5));
    history.lights_moved(lights(3), lights(5));
    EXPECT_EQ(history.undo_name(), "Speed");
    history.undo(desired);
    EXPECT_EQ(desired.speed, 1);
    EXPECT_EQ(desired.pose.time_s, 1.5);
    EXPECT_EQ(desired.lights[0].values.position[0], 5);
    // A light that the user moved stays.
    desired.lights[0].values.position[0] = 9;
    history.observe(desired, false);
    follow_lights(desired, lights(5), lights(7));
    EXPECT_EQ(desired.lights[0].values.position[0], 9);
    desired.pose = {2.0, "run"};
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Clip");
    history.undo(desired);
    EXPECT_EQ(desired.pose.clip, "walk");
}

}  // namespace
}  // namespace clarity::ui
