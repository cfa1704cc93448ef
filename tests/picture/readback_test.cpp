// readback_test.cpp -- consecutive pictures, each copied while the next one is traced. No picture is lost, doubled or torn, and
// none changes while a reader holds it. A GPU copies with a queue of its own. The parameter "gpu" lets a CPU pretend to be one,
// so that it does the same.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

const char* const kEyes[] = {"0,2.5,11,0,2.2,0,50", "1,2.5,10,0,2.2,0,50", "2,2.5,9,0,2.2,0,50", "3,2.5,9,0,2.2,0,50",
                             "4,2.6,9,0,2.2,0,50"};

class AsyncReadbacks : public ::testing::TestWithParam<const char*> {
 protected:
    static DeviceInfo posing() {
        DeviceInfo info = choose_device("");
        if (std::string(GetParam()) == "gpu") info.cpu = false, info.gpu = true;
        return info;
    }
    AsyncReadbacks()
        : device_(std::make_shared<Device>(posing())),
          preparer_(Workbench::get().plugins(), device_),
          frames_(std::make_unique<FrameRenderer>(device_)) {
        prepared_ = preparer_.prepare(scene_, settings_, progress_);
    }
    void trace(const char* eye, unsigned sample = 0, const std::function<void()>& meanwhile = {}) {
        frames_->trace(*prepared_, settings_, make_view(*scene_, 4.0f / 3, eye), sample, false, progress_, nullptr, meanwhile);
    }
    std::vector<uint8_t> picture() { return bytes(frames_->read_display(settings_)); }
    static std::vector<uint8_t> bytes(const ByteImage& image) { return {image.pixels.begin(), image.pixels.end()}; }
    void resize(int width, int height) {
        settings_.width = width;
        settings_.height = height;
    }

    Progress progress_;
    ScenePtr scene_ = load_scene(source_file("scenes/primitives.scene"));
    Settings settings_ = make_settings({{"accel", "bvh2"}, {"size", "96x72"}, {"portable", "true"}});
    std::shared_ptr<Device> device_;
    Preparer preparer_;
    std::unique_ptr<FrameRenderer> frames_;
    std::shared_ptr<const Prepared> prepared_;
};

TEST_P(AsyncReadbacks, ReturnEachPictureWhileTheNextIsTraced) {
    std::vector<std::vector<uint8_t>> expected;
    for (const char* eye : kEyes) {
        trace(eye);
        expected.push_back(picture());
    }
    std::vector<ByteImage> seen;
    AsyncReadback pending;
    std::vector<KernelTime> times;
    for (int run = 0; run < 2; ++run) {
        for (size_t i = 0; i < std::size(kEyes); ++i) {
            int calls = 0;
            trace(kEyes[i], 0, [&] {
                ++calls;
                if (pending) seen.push_back(pending.wait(&times));
            });
            EXPECT_EQ(calls, 1);
            EXPECT_EQ(seen.size(), run * std::size(kEyes) + i);
            EXPECT_FALSE(pending);
            pending = frames_->begin_display(settings_);
            EXPECT_TRUE(pending);
        }
        seen.push_back(pending.wait(&times));
    }
    EXPECT_EQ(times.size(), 2 * seen.size());
    ASSERT_EQ(seen.size(), 2 * expected.size());
    for (size_t i = 0; i < seen.size(); ++i) EXPECT_TRUE(bytes(seen[i]) == expected[i % expected.size()]) << i;
    EXPECT_EQ(frames_->overlaps_copies(), std::string(GetParam()) == "gpu");
}

// Pictures may be waited for in any order, after their renderer is gone, or never.
TEST_P(AsyncReadbacks, OutliveTheirRendererAndMayBeWaitedForInAnyOrder) {
    std::vector<std::vector<uint8_t>> expected;
    std::vector<AsyncReadback> pending;
    for (const char* eye : kEyes) {
        trace(eye);
        expected.push_back(picture());
        trace(eye);
        pending.push_back(frames_->begin_display(settings_));
    }
    pending[1] = {};
    frames_.reset();
    prepared_.reset();
    std::vector<ByteImage> seen(pending.size());
    for (const size_t i : {3u, 0u, 4u, 2u}) seen[i] = pending[i].wait();
    for (const size_t i : {3u, 0u, 4u, 2u}) EXPECT_TRUE(bytes(seen[i]) == expected[i]) << i;
}

// A copy that was begun is not used if the tone mapping changes, more samples are added, or the picture is displayed in another
// way.
TEST_P(AsyncReadbacks, ReturnTheCurrentFilmAfterChangesOfToneOrSamples) {
    for (const char* eye : {kEyes[0], kEyes[1]}) {
        trace(eye);
        frames_->begin_display(settings_).wait();
    }
    trace(kEyes[2]);
    settings_.exposure = 1.7;
    const std::vector<uint8_t> brighter = picture();
    EXPECT_TRUE(bytes(frames_->begin_display(settings_).wait()) == brighter);

    trace(kEyes[2]);
    AsyncReadback first = frames_->begin_display(settings_);
    trace(kEyes[2], 1);
    const std::vector<uint8_t> smoother = picture();
    EXPECT_FALSE(smoother == brighter);
    AsyncReadback second = frames_->begin_display(settings_);
    EXPECT_TRUE(picture() == smoother);
    EXPECT_TRUE(bytes(first.wait()) == brighter);
    EXPECT_TRUE(bytes(second.wait()) == smoother);
}

TEST_P(AsyncReadbacks, SizesMayChangeBetweenPictures) {
    std::vector<std::vector<uint8_t>> expected;
    std::vector<AsyncReadback> pending;
    for (const auto& [width, height] : {std::pair{96, 72}, {40, 30}, {200, 150}, {33, 31}, {64, 48}}) {
        resize(width, height);
        trace(kEyes[0]);
        expected.push_back(picture());
        pending.push_back(frames_->begin_display(settings_));
    }
    for (size_t i = 0; i < pending.size(); ++i) EXPECT_TRUE(bytes(pending[i].wait()) == expected[i]) << i;
}

// `meanwhile` is not called if no launch was made, for example after a cancel.
TEST_P(AsyncReadbacks, ACancelledTraceKeepsThePendingPicture) {
    trace(kEyes[0]);
    const std::vector<uint8_t> before = picture();
    AsyncReadback pending = frames_->begin_display(settings_);
    Progress cancelled;
    cancelled.cancel();
    int calls = 0;
    EXPECT_THROW(frames_->trace(*prepared_, settings_, make_view(*scene_, 4.0f / 3, kEyes[1]), 0, false, cancelled, nullptr,
                                [&] { ++calls; }),
                 Cancelled);
    EXPECT_EQ(calls, 0);
    EXPECT_TRUE(bytes(pending.wait()) == before);
}

INSTANTIATE_TEST_SUITE_P(Devices, AsyncReadbacks, ::testing::Values("cpu", "gpu"));

}  // namespace
