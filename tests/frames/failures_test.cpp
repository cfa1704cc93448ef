// failures_test.cpp -- a device that has no memory left or refuses a launch causes an error message. Later pictures must be
// unaffected.
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.hpp"
#include "support/errors.hpp"
#include "support/faults.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

class Failures : public ::testing::TestWithParam<const char*> {
 protected:
    void SetUp() override {
        scene_ = load_scene(source_file("scenes/primitives.scene"));
        view_ = make_view(*scene_, 4.0f / 3);
        small_ = make_settings({{"accel", "bvh2"}, {"size", "80x60"}, {"lanes", "8"}, {"tracer", GetParam()}});
        large_ = small_;
        large_.width = 1600;
        large_.height = 1200;
        prepared_ = preparer_.prepare(scene_, small_, progress_);
        frames_.trace(*prepared_, small_, view_, 0, true, progress_);
        truth_ = frames_.read_values().pixels;
    }
    void TearDown() override { faults.end(); }

    // Returns the message of the error that `work` must end with.
    template <class Work>
    static std::string message(Work&& work) {
        return expect_error(work, {}, Exit::failed);
    }
    void expect_all_is_well(const std::string& after) {
        faults.end();
        for (int picture = 0; picture < 2; ++picture) {
            frames_.trace(*prepared_, small_, view_, 0, true, progress_);
            const FloatPixels pixels = frames_.read_values().pixels;
            ASSERT_EQ(pixels.size(), truth_.size()) << after;
            EXPECT_EQ(std::memcmp(pixels.data(), truth_.data(), truth_.size() * sizeof(float)), 0) << after;
        }
    }

    std::shared_ptr<Device> device_ = std::make_shared<Device>(choose_device(""));
    Preparer preparer_{Workbench::get().plugins(), device_};
    FrameRenderer frames_{device_};
    Progress progress_;
    ScenePtr scene_;
    View view_;
    Settings small_, large_;
    std::shared_ptr<const Prepared> prepared_;
    FloatPixels truth_;
};

TEST_P(Failures, TooLittleMemoryForAPicture) {
    faults.largest_buffer = 1 << 20;
    const std::string said = message([&] { frames_.trace(*prepared_, large_, view_, 0, false, progress_); });
    EXPECT_NE(said.find(device_->info().name), std::string::npos) << said;
    EXPECT_NE(said.find("out of memory"), std::string::npos) << said;
    expect_all_is_well("no room for a picture");
}

TEST_P(Failures, TooLittleMemoryForASceneKeepsTheLastScene) {
    faults.largest_buffer = 0;
    const ScenePtr other = load_scene(source_file("scenes/cornell.scene"));
    const std::string said = message([&] { preparer_.prepare(other, small_, progress_); });
    EXPECT_NE(said.find("no room on " + device_->info().name), std::string::npos) << said;
    EXPECT_NE(said.find("MiB"), std::string::npos) << said;
    expect_all_is_well("no room for a scene");
    EXPECT_NO_THROW(preparer_.prepare(scene_, small_, progress_));
}

// Refuses each launch of a picture in turn: tracing, sums of counters, tone mapping.
TEST_P(Failures, ARefusedLaunch) {
    for (int launch = 0; launch < 12; ++launch) {
        faults.launches_left = launch;
        try {
            FrameStats stats = frames_.trace(*prepared_, small_, view_, 0, true, progress_);
            frames_.read_display(small_, &stats);
            EXPECT_GT(launch, 2) << "a picture of so few launches?";
            return;  // this one needed no more
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::failed) << error.what();
            EXPECT_NE(std::string(error.what()).find(device_->info().name), std::string::npos) << error.what();
        }
        expect_all_is_well("launch " + std::to_string(launch) + " was refused");
    }
}

// Uses a CPU that pretends to be a GPU, so that copies have a queue of their own.
class CopyFailures : public Failures {
 protected:
    void SetUp() override {
        Failures::SetUp();
        DeviceInfo info = device_->info();
        info.cpu = false;
        info.gpu = true;
        const auto device = std::make_shared<Device>(info);
        small_.lanes = small_.packet_w = small_.packet_h = 1;
        prepared_ = Preparer(Workbench::get().plugins(), device).prepare(scene_, small_, progress_);
        copying_ = std::make_unique<FrameRenderer>(device);
    }

    std::unique_ptr<FrameRenderer> copying_;
};

// Consecutive pictures.
TEST_P(CopyFailures, ARefusedLaunchBetweenPictures) {
    AsyncReadback pending;
    ByteImage shown;
    const auto show = [&] {
        copying_->trace(*prepared_, small_, view_, 0, false, progress_, nullptr, [&] {
            if (pending) shown = pending.wait();
        });
        pending = copying_->begin_display(small_);
    };
    show();
    const ByteImage truth = copying_->read_display(small_);
    for (int launch = 0; launch < 12; ++launch) {
        faults.launches_left = launch;
        bool failed = false;
        try {
            show();
        } catch (const Error& error) {
            failed = true;
            EXPECT_EQ(error.code(), Exit::failed) << error.what();
        }
        faults.end();
        EXPECT_TRUE(!pending || pending.wait().pixels == truth.pixels) << "launch " << launch;
        for (int picture = 0; picture < 3; ++picture) {
            shown = {};
            show();
        }
        EXPECT_TRUE(shown.pixels == truth.pixels) << "launch " << launch;
        EXPECT_TRUE(pending.wait().pixels == truth.pixels) << "launch " << launch;
        show();
        if (!failed) {
            EXPECT_GT(launch, 1) << "a picture of so few launches?";
            return;
        }
    }
}

// A refused copy causes an error message, and the pictures after it are complete.
TEST_P(CopyFailures, ARefusedCopy) {
    copying_->trace(*prepared_, small_, view_, 0, false, progress_);
    AsyncReadback before = copying_->begin_display(small_);
    const ByteImage truth = copying_->read_display(small_);
    faults.copies_left = 0;
    const std::string said = message([&] {
        copying_->trace(*prepared_, small_, view_, 0, false, progress_);
        copying_->begin_display(small_);
    });
    EXPECT_NE(said.find(device_->info().name), std::string::npos) << said;
    faults.end();
    EXPECT_TRUE(before.wait().pixels == truth.pixels);
    copying_->trace(*prepared_, small_, view_, 0, false, progress_);
    EXPECT_TRUE(copying_->begin_display(small_).wait().pixels == truth.pixels);
}

INSTANTIATE_TEST_SUITE_P(Tracers, Failures, ::testing::Values("iterative", "wavefront"));
INSTANTIATE_TEST_SUITE_P(Tracers, CopyFailures, ::testing::Values("iterative", "wavefront"));

}  // namespace
