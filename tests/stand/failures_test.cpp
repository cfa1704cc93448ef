// failures_test.cpp -- a device that fails causes a warning, and the picture is complete.
#include <cstring>
#include <mutex>

#include "base/log.hpp"
#include "stand/team.hpp"
#include "support/errors.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// Collects the log's warnings during its lifetime.
class Warnings {
 public:
    Warnings() {
        set_log_listener([this](LogLevel level, const std::string& text) {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (level == LogLevel::warning) text_ += text + "\n";
        });
    }
    ~Warnings() { set_log_listener({}); }
    std::string text() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return text_;
    }

 private:
    std::mutex mutex_;
    std::string text_;
};

class FailingDevice : public ::testing::Test {
 protected:
    void SetUp() override {
        if (const std::string why = why_no_parts(); !why.empty()) GTEST_SKIP() << why;
        scene_ = load_scene(source_file("scenes/primitives.scene"));
        view_ = make_view(*scene_, 160.0f / 120.0f);
        Team whole("cpu");
        whole.trace(scene_, settings_, view_, 0, 4);
        truth_ = whole.frames.read_values().pixels;
        display_ = whole.frames.read_display(settings_).pixels;
    }
    // Without a context and a queue, every call of a device fails.
    void lose(Team& team, size_t device) {
        team.devices[device]->queue() = Queue();
        team.devices[device]->context() = cl::Context();
    }
    void expect_whole(Team& team, Warnings& warnings) {
        EXPECT_EQ(differing(truth_, team.frames.read_values().pixels), 0u);
        EXPECT_TRUE(display_ == team.frames.read_display(settings_).pixels);
        EXPECT_NE(warnings.text().find("0:0/2.1 takes no further part"), std::string::npos) << warnings.text();
        EXPECT_NE(warnings.text().find("part 2 of 2"), std::string::npos)
            << "the warning names the device: " << warnings.text();
    }

    const Settings settings_ = make_settings({{"size", "160x120"}});
    ScenePtr scene_;
    View view_;
    FloatPixels truth_;
    SharedBytes display_;
};

TEST_F(FailingDevice, OthersTakeOverBeforeAPicture) {
    Team team("0:0/2");
    const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
    Warnings warnings;
    lose(team, 1);
    const FrameStats stats = team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 4);
    ASSERT_EQ(stats.devices.size(), 1u);
    EXPECT_EQ(stats.devices[0].share, 1);
    expect_whole(team, warnings);
}

TEST_F(FailingDevice, OthersTakeOverBetweenSamples) {
    Team team("0:0/2");
    const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
    Warnings warnings;
    team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 2);
    lose(team, 1);
    EXPECT_EQ(team.frames.trace(prepared, settings_, view_, 2, false, team.progress, 2).samples, 4u);
    expect_whole(team, warnings);
}

// Of a picture that goes on from sums, the tiles of a lost device begin with these sums again.
TEST_F(FailingDevice, OthersTakeOverInAPictureThatGoesOn) {
    Team first("0:0/2");
    first.trace(scene_, settings_, view_, 0, 2);
    const auto sums = std::make_shared<const FloatImage>(first.frames.read_sums());
    for (const bool at_once : {true, false}) {
        Team team("0:0/2");
        const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
        Warnings warnings;
        team.frames.resume(prepared, settings_, sums, 2);
        if (at_once) lose(team, 1);
        team.frames.trace(prepared, settings_, view_, 2, false, team.progress, 1);
        if (!at_once) lose(team, 1);
        EXPECT_EQ(team.frames.trace(prepared, settings_, view_, 3, false, team.progress, 1).samples, 4u);
        expect_whole(team, warnings);
    }
}

TEST_F(FailingDevice, OthersTakeOverBeforeItsFilmIsReadBack) {
    Team team("0:0/2");
    const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
    Warnings warnings;
    team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 4);
    lose(team, 1);
    expect_whole(team, warnings);
    const FloatImage distance = team.frames.read_distance();
    EXPECT_EQ(distance.pixels.size(), 160u * 120u);
    // The following pictures work too.
    EXPECT_EQ(team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 4).devices.size(), 1u);
    expect_whole(team, warnings);
}

TEST_F(FailingDevice, OthersTakeOverBeforeItsDisplayPixelsAreReadBack) {
    Team team("0:0/2");
    const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
    Warnings warnings;
    for (int picture = 0; picture < 2; ++picture) {
        team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 4);
        EXPECT_TRUE(display_ == team.frames.read_display(settings_).pixels);
    }
    lose(team, 1);
    // Pictures as short as these are also traced by one device, by trial; then the other one is not asked.
    for (int picture = 0; picture < 8 && warnings.text().empty(); ++picture) {
        team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 4);
        EXPECT_TRUE(display_ == team.frames.read_display(settings_).pixels);
    }
    expect_whole(team, warnings);
}

TEST_F(FailingDevice, OthersTakeOverDuringPreparation) {
    Team team("0:0/2");
    Warnings warnings;
    lose(team, 1);
    const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
    ASSERT_EQ(prepared->parts.size(), 1u);
    EXPECT_NE(warnings.text().find("part 2 of 2"), std::string::npos) << warnings.text();
    team.frames.trace(prepared, settings_, view_, 0, false, team.progress, 4);
    EXPECT_EQ(differing(truth_, team.frames.read_values().pixels), 0u);
}

TEST_F(FailingDevice, ThrowsIfAllDevicesFail) {
    Team team("0:0/2");
    const auto prepared = team.preparer.prepare(scene_, settings_, team.progress);
    lose(team, 0);
    lose(team, 1);
    expect_error([&] { team.frames.trace(prepared, settings_, view_, 0, false, team.progress); }, {"OpenCL error"},
                 Exit::failed);
    EXPECT_THROW(team.frames.trace(prepared, settings_, view_, 0, false, team.progress), Error);
}

TEST_F(FailingDevice, DevicesOpenedAgainWork) {
    Team team("0:0/2");
    team.trace(scene_, settings_, view_);
    team.frames.~MultiFrameRenderer();
    const Devices anew = open_devices(team.preparer.close_devices());
    new (&team.frames) MultiFrameRenderer(anew);
    team.preparer.open_devices(anew);
    team.trace(scene_, settings_, view_, 0, 4);
    EXPECT_EQ(differing(truth_, team.frames.read_values().pixels), 0u);
}

}  // namespace
