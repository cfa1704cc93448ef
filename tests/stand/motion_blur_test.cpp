// motion_blur_test.cpp -- pictures whose samples are spread in time, beside still pictures of the samples' times.
#include "stand/motion_blur.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "import/import.hpp"
#include "stand/multi_device_film.hpp"
#include "stand/team.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

std::string obj(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

// A sail that bulges and whose upper edge is moved aside by `lean`. Its normals change with it.
std::string sail(double lean) {
    constexpr int kColumns = 3, kRows = 6;
    std::vector<std::string> lines = {"vn 0 0 1"};
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const double up = double(row) / (kRows - 1);
            lines.push_back("v " + std::to_string(1.5 + 0.5 * column + lean * up) + " " + std::to_string(2 * up - 1) + " " +
                            std::to_string(lean * std::sin(3.14159 * up)));
        }
    for (int row = 0; row + 1 < kRows; ++row)
        for (int column = 0; column + 1 < kColumns; ++column) {
            const int first = row * kColumns + column + 1;
            std::string face = "f";
            for (const int corner : {first, first + 1, first + kColumns + 1, first + kColumns})
                face += " " + std::to_string(corner) + "//1";
            lines.push_back(face);
        }
    return obj(lines);
}

class Blur : public ::testing::Test {
 protected:
    // A box that moves, a mesh that deforms, a camera that turns and a lamp that passes by.
    void SetUp() override {
        scratch_.write("box.obj", obj({"v -.5 -.5 0", "v .5 -.5 0", "v .5 .5 0", "v -.5 .5 0", "f 1 2 3 4"}));
        scratch_.write("sail_00.obj", sail(0));
        scratch_.write("sail_24.obj", sail(-1.2));
        const std::string path = scratch_.write("moves.scene",
                                                "camera main eye 0 0 9 target 0 0 0 fov 40\n"
                                                "light point position 0 0 6 color 1 1 1 name lamp\n"
                                                "background .2 .3 .5\n"
                                                "material red color .9 .2 .1\n"
                                                "polygon vertices -6 -3 -2  6 -3 -2  6 3 -2  -6 3 -2\n"
                                                "load box.obj name box material red\n"
                                                "load \"sail_##.obj\" material red\n"
                                                "animate box translate 0 -2 0 0  1 0 1 0\n"
                                                "animate main rotate 0 0 1 0 0  1 0 1 0 4\n"
                                                "animate lamp translate 0 -4 2 6  1 4 2 6\n");
        rest_ = load_scene(path);
        sequences_ = std::make_unique<import::SequenceReader>(Workbench::get().plugins(), import::ImportOptions(), progress_);
    }
    Pose pose(double time_s) { return evaluate(*rest_, {}, time_s, std::ref(*sequences_)); }
    ScenePtr scene_at(double time_s) { return std::make_shared<const Scene>(posed(*rest_, pose(time_s))); }
    static View view_of(const Scene& scene) { return make_view(scene, 64.0f / 48); }

    FloatImage still(Team& team, double time_s, const Settings& settings) {
        const ScenePtr scene = scene_at(time_s);
        team.trace(scene, settings, view_of(*scene), 0, unsigned(settings.spp));
        return team.frames.read_values();
    }
    struct Blurred {
        FloatImage image;
        unsigned refitted = 0, built = 0;
    };
    Blurred blurred(Team& team, const Shutter& shutter, const Settings& settings) {
        const ScenePtr scene = scene_at(shutter.time_s);
        MotionBlur::Source source;
        source.rest = rest_;
        source.read = std::ref(*sequences_);
        source.prepare = [&](const ScenePtr& posed, Progress& progress) {
            return team.preparer.prepare(posed, settings, progress);
        };
        MotionBlur blur(source, shutter, team.preparer.prepare(scene, settings, team.progress));
        for (unsigned i = 0; i < shutter.samples; ++i) {
            const MotionBlur::Sample& sample = blur.at(i, view_of(*scene), team.progress);
            team.frames.trace(sample.prepared, settings, *sample.view, i, false, team.progress);
        }
        return {team.frames.read_values(), blur.refitted(), blur.built()};
    }
    static double mean_difference(const FloatImage& a, const FloatImage& b) {
        double sum = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::fabs(double(a.pixels[i]) - double(b.pixels[i]));
        return sum / double(a.pixels.size());
    }
    static double largest_difference(const FloatImage& a, const FloatImage& b) {
        double most = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i)
            most = std::max(most, std::fabs(double(a.pixels[i]) - double(b.pixels[i])));
        return most;
    }

    const Settings settings_ = make_settings({{"size", "64x48"}, {"spp", "64"}, {"shutter", "1"}});
    Scratch scratch_;
    ScenePtr rest_;
    Progress progress_;
    std::unique_ptr<import::SequenceReader> sequences_;
};

TEST(Shutter, EachPartOfTheTimeHasOneSample) {
    for (const unsigned count : {2u, 3u, 4u, 16u, 60u, 64u, 1000u}) {
        std::set<long> parts;
        for (unsigned i = 0; i < count; ++i) {
            const double part = (sample_time({5, 2, count}, i) - 4) / 2 * count - 0.5;
            EXPECT_NEAR(part, std::round(part), 1e-6);
            parts.insert(std::lround(part));
        }
        EXPECT_EQ(parts.size(), count);
        EXPECT_EQ(*parts.begin(), 0);
        EXPECT_EQ(*parts.rbegin(), long(count) - 1);
    }
}

TEST(Shutter, OneSampleIsAtThePicturesTime) {
    EXPECT_EQ(sample_time({5, 2, 1}, 0), 5);
    EXPECT_EQ(sample_time({5, 0, 64}, 7), 5);
}

TEST(Shutter, TheFirstSamplesAreSpreadToo) {
    double sum = 0;
    for (unsigned i = 0; i < 16; ++i) sum += sample_time({0, 1, 1024}, i) / 16;
    EXPECT_NEAR(sum, 0, 0.05);
}

// 64 samples at times of their own are the mean of 64 still pictures, each built from the ground up.
TEST_F(Blur, IsTheMeanOfStillPictures) {
    Team team("cpu");
    const Shutter shutter = {0.5, 1, 64};
    const Blurred blur = blurred(team, shutter, settings_);
    EXPECT_EQ(blur.refitted, 64u);
    EXPECT_EQ(blur.built, 0u);
    Settings of_still = settings_;
    of_still.spp = 16;
    FloatImage mean;
    for (int i = 0; i < 64; ++i) {
        const FloatImage one = still(team, (i + 0.5) / 64, of_still);
        if (mean.pixels.empty()) mean = {one.width, one.height, one.channels, FloatPixels(one.pixels.size(), 0.0f)};
        for (size_t p = 0; p < one.pixels.size(); ++p) mean.pixels[p] += one.pixels[p] / 64;
    }
    const double difference = mean_difference(blur.image, mean), without = mean_difference(still(team, 0.5, settings_), mean);
    RecordProperty("difference", std::to_string(difference));
    RecordProperty("without", std::to_string(without));
    EXPECT_LT(difference, 0.004);
    EXPECT_LT(largest_difference(blur.image, mean), 0.12) << "no pixel is of another time";
    EXPECT_GT(without, 10 * difference) << "the picture is not blurred without it";
}

// Structures without refits, poses of which the structure cannot be refitted, and `poses=build` are built for each sample.
TEST_F(Blur, BuildsWhereItCannotRefit) {
    Team team("cpu");
    const Shutter shutter = {0.5, 1, 8};
    Settings settings = settings_, built = settings_, linear = settings_;
    settings.spp = built.spp = linear.spp = 8;
    built.poses = "build";
    linear.accel = "linear";
    const Blurred refits = blurred(team, shutter, settings), builds = blurred(team, shutter, built),
                  cannot = blurred(team, shutter, linear);
    EXPECT_EQ(refits.built, 0u);
    EXPECT_EQ(builds.built, 8u);
    EXPECT_EQ(cannot.built, 8u);
    EXPECT_LT(largest_difference(refits.image, builds.image), 1e-5);
    EXPECT_LT(largest_difference(refits.image, cannot.image), 1e-5);
}

// Where only the camera and lights move, all samples share everything that is on the device.
TEST_F(Blur, WhatDoesNotMoveIsNeitherBuiltNorUploaded) {
    rest_ = load_scene(scratch_.write("still.scene",
                                      "camera main eye 0 0 9 target 0 0 0 fov 40\n"
                                      "light point position 0 0 6 name lamp\n"
                                      "polygon vertices -6 -3 -2  6 -3 -2  6 3 -2  -6 3 -2\n"
                                      "load box.obj\nload box.obj translate 1 1 0\nload sail_00.obj\n"
                                      "animate main rotate 0 0 1 0 0  1 0 1 0 4\n"
                                      "animate lamp translate 0 -4 2 6  1 4 2 6\n"));
    Team team("cpu");
    const ScenePtr scene = scene_at(0.5);
    const auto prepared = team.preparer.prepare(scene, settings_, team.progress);
    MotionBlur::Source source;
    source.rest = rest_;
    MotionBlur blur(source, {0.5, 1, 4}, prepared);
    std::set<float> lamps, targets;
    for (unsigned i = 0; i < 4; ++i) {
        const MotionBlur::Sample& sample = blur.at(i, view_of(*scene), team.progress);
        EXPECT_EQ(sample.prepared, prepared);
        lamps.insert(sample.view->lights.at(0).position[0]);
        targets.insert(sample.view->camera.target[0]);
        EXPECT_EQ(sample.view->lights.at(0).position[0], evaluate(*rest_, {}, sample.time_s).lights.at(0).values.position[0]);
    }
    EXPECT_EQ(lamps.size(), 4u);
    EXPECT_EQ(targets.size(), 4u);
    // The user's own camera and light stand still.
    View own = view_of(*scene);
    own.camera.eye[0] += 1;
    own.lights[0].position[1] += 1;
    const MotionBlur::Sample& sample = blur.at(1, own, team.progress);
    EXPECT_EQ(sample.view->camera.eye, own.camera.eye);
    EXPECT_EQ(sample.view->lights[0].position[0], own.lights[0].position[0]);
}

TEST_F(Blur, PicturesBeforeLeaveNoTrace) {
    Team team("cpu");
    Settings settings = settings_;
    settings.spp = 8;
    const FloatImage first = blurred(team, {0.5, 1, 8}, settings).image;
    blurred(team, {0.1, 0.2, 8}, settings);
    EXPECT_EQ(differing(first.pixels, blurred(team, {0.5, 1, 8}, settings).image.pixels), 0u);
}

TEST_F(Blur, DevicesThatShareThePictureMakeTheSame) {
    if (const std::string why = why_no_parts(); !why.empty()) GTEST_SKIP() << why;
    Team whole("cpu"), parts("0:0/2");
    Settings settings = settings_;
    settings.spp = 8;
    const FloatImage one = blurred(whole, {0.5, 1, 8}, settings).image, two = blurred(parts, {0.5, 1, 8}, settings).image;
    EXPECT_EQ(differing(one.pixels, two.pixels), 0u);
}

// What a lost device has traced cannot be traced again: its poses are gone. The picture begins anew without it.
TEST_F(Blur, APictureThatLostADeviceBeginsAnew) {
    if (const std::string why = why_no_parts(); !why.empty()) GTEST_SKIP() << why;
    Team team("0:0/2");
    Settings settings = make_settings({{"size", "160x120"}, {"spp", "8"}, {"shutter", "1"}});
    const ScenePtr scene = scene_at(0.5);
    const auto prepared = team.preparer.prepare(scene, settings, team.progress);
    // On a busy machine one device may be so late that the other takes the whole picture.
    const auto both_take_part = [&] {
        const FrameStats stats = team.frames.trace(prepared, settings, view_of(*scene), 0, false, team.progress, 2);
        return stats.devices.size() == 2 && stats.devices[0].share > 0 && stats.devices[1].share > 0;
    };
    bool shared = false;
    for (int picture = 0; picture < 20 && !shared; ++picture) shared = both_take_part();
    ASSERT_TRUE(shared);
    team.devices[1]->queue() = Queue();
    team.devices[1]->context() = cl::Context();
    EXPECT_THROW(team.frames.trace(prepared, settings, view_of(*scene), 2, false, team.progress), SamplesLost);
    EXPECT_EQ(team.frames.trace(prepared, settings, view_of(*scene), 0, false, team.progress, 8).samples, 8u);
}

TEST(Shutter, IsOffByDefault) {
    EXPECT_FALSE(blurs(Settings()));
    EXPECT_FALSE(blurs(make_settings({{"shutter", "0.5"}}))) << "one sample cannot be spread";
    EXPECT_TRUE(blurs(make_settings({{"shutter", "0.5"}, {"spp", "2"}})));
    EXPECT_FALSE(blurs(make_settings({{"shutter", "0.5"}, {"spp", "2"}, {"aov", "t"}})));
}

}  // namespace
