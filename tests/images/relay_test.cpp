// relay_test.cpp -- picture after picture, each copied while the next is traced: none is lost, doubled or torn. A GPU copies by
// a queue of its own; here a CPU that says it is one does so too.
#include <gtest/gtest.h>

#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

const char* const kEyes[] = {"0,2.5,11,0,2.2,0,50", "1,2.5,10,0,2.2,0,50", "2,2.5,9,0,2.2,0,50", "3,2.5,9,0,2.2,0,50",
                             "4,2.6,9,0,2.2,0,50"};

class Relay : public ::testing::TestWithParam<const char*> {
 protected:
    static DeviceInfo posing() {
        DeviceInfo info = choose_device("");
        if (std::string(GetParam()) == "gpu") info.cpu = false, info.gpu = true;
        return info;
    }
    Relay() : device_(std::make_shared<Device>(posing())), preparer_(Workbench::get().plugins(), device_), frames_(device_) {
        prepared_ = preparer_.prepare(scene_, settings_, progress_);
    }
    void trace(const char* eye, unsigned sample = 0) {
        frames_.trace(*prepared_, settings_, make_view(*scene_, 4.0f / 3, eye), sample, false, progress_);
    }
    std::vector<uint8_t> picture() { return frames_.read_display(settings_).pixels; }
    std::vector<uint8_t> bytes(const uint8_t* seen) const {
        return seen ? std::vector<uint8_t>(seen, seen + size_t(settings_.width) * size_t(settings_.height) * 4)
                    : std::vector<uint8_t>();
    }
    void resize(int width, int height) {
        settings_.width = width;
        settings_.height = height;
    }

    Progress progress_;
    ScenePtr scene_ = load_scene(source_file("scenes/primitives.scene"));
    Settings settings_ = make_settings({{"accel", "bvh2"}, {"size", "96x72"}, {"portable", "true"}});
    std::shared_ptr<Device> device_;
    Preparer preparer_;
    Frames frames_;
    std::shared_ptr<const Prepared> prepared_;
};

TEST_P(Relay, GivesEachPictureOneTraceLater) {
    std::vector<std::vector<uint8_t>> expected;
    for (const char* eye : kEyes) {
        trace(eye);
        expected.push_back(picture());
    }
    for (int run = 0; run < 2; ++run) {
        for (size_t i = 0; i < std::size(kEyes); ++i) {
            trace(kEyes[i]);
            FrameStats stats;
            const std::vector<uint8_t> before = bytes(frames_.exchange_display(settings_, &stats));
            EXPECT_EQ(stats.kernels.size(), i == 0 ? 0u : 2u);
            EXPECT_TRUE(before == (i == 0 ? std::vector<uint8_t>() : expected[i - 1])) << "run " << run << ", picture " << i;
        }
        EXPECT_TRUE(bytes(frames_.last_display()) == expected.back()) << "run " << run;
        EXPECT_EQ(frames_.last_display(), nullptr);
    }
}

// What was begun of a film is not what is handed in where the tones are others, more samples are in, or it was shown otherwise.
TEST_P(Relay, HandsInTheFilmAsItIs) {
    for (const char* eye : {kEyes[0], kEyes[1]}) {
        trace(eye);
        frames_.exchange_display(settings_);
    }
    trace(kEyes[2]);
    settings_.exposure = 1.7;
    const std::vector<uint8_t> brighter = picture();
    frames_.exchange_display(settings_);
    EXPECT_TRUE(bytes(frames_.last_display()) == brighter);

    trace(kEyes[2]);
    frames_.exchange_display(settings_);
    trace(kEyes[2], 1);
    const std::vector<uint8_t> smoother = picture();
    EXPECT_TRUE(bytes(frames_.look_at_display(settings_)) == smoother);
    EXPECT_TRUE(bytes(frames_.exchange_display(settings_)) == brighter);
    EXPECT_TRUE(bytes(frames_.last_display()) == smoother);
}

TEST_P(Relay, SizesMayChangeOnTheWay) {
    std::vector<uint8_t> last;
    for (const auto& [width, height] : {std::pair{96, 72}, {40, 30}, {200, 150}, {33, 31}, {64, 48}}) {
        resize(width, height);
        trace(kEyes[0]);
        const std::vector<uint8_t> now = picture();
        const uint8_t* const seen = frames_.exchange_display(settings_);
        EXPECT_TRUE(std::equal(last.begin(), last.end(), seen)) << width << "x" << height;
        last = now;
    }
    EXPECT_TRUE(bytes(frames_.last_display()) == last);
}

INSTANTIATE_TEST_SUITE_P(Devices, Relay, ::testing::Values("cpu", "gpu"));

}  // namespace
