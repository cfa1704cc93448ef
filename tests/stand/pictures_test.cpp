// pictures_test.cpp -- a picture that several devices share equals, bit for bit, the picture of a single device.
#include <cstring>

#include "picture/frame_stats.hpp"
#include "stand/team.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// Settings with one structure, which compiles quickly.
Settings settings_of(std::vector<std::pair<std::string, std::string>> pairs) {
    pairs.emplace_back("accel", "bvh2");
    return make_settings(pairs);
}

class SharedPictures : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        if (!why_no_parts().empty()) return;
        one_ = new Team("cpu");  // never destroyed: an OpenCL driver may be gone before static objects are
        two_ = new Team("cpu/2");
    }
    void SetUp() override {
        if (!two_) GTEST_SKIP() << why_no_parts();
    }

    static void expect_same(const ScenePtr& scene, const Settings& settings, const std::string& what, unsigned samples = 1) {
        const View view = make_view(*scene, float(settings.width) / float(settings.height));
        const FrameStats alone = one_->trace(scene, settings, view, 0, samples),
                         shared = two_->trace(scene, settings, view, 0, samples);
        EXPECT_EQ(shared.devices.size(), 2u) << what;
        EXPECT_EQ(shared.samples, samples) << what;
        EXPECT_EQ(two_->frames.samples(), samples) << what;
        EXPECT_EQ(shared.primary, alone.primary) << what;
        EXPECT_EQ(shared.shadow, alone.shadow) << what;
        EXPECT_EQ(shared.secondary, alone.secondary) << what;
        EXPECT_EQ(shared.dropped, alone.dropped) << what;
        double whole = 0;
        for (const DeviceShare& share : shared.devices) whole += share.share;
        EXPECT_NEAR(whole, 1, 1e-9) << what;
        compare_films(settings, what);
    }

    // Compares everything that can be read of both pictures.
    static void compare_films(const Settings& settings, const std::string& what) {
        EXPECT_EQ(differing(one_->frames.read_values().pixels, two_->frames.read_values().pixels), 0u) << what;
        EXPECT_EQ(differing(one_->frames.read_distance().pixels, two_->frames.read_distance().pixels), 0u) << what;
        FrameStats stats = {};
        stats.devices.resize(2);
        FalseColorScale scale, one_scale;
        const ByteImage display = one_->frames.read_display(settings, nullptr, &one_scale),
                        shared = two_->frames.read_display(settings, &stats, &scale);
        EXPECT_TRUE(display.pixels == shared.pixels) << what;
        EXPECT_TRUE(shared.pixels == two_->frames.read_display(settings).pixels)
            << what << ": a second read gives another picture";
        EXPECT_FALSE(stats.kernels.empty()) << what;
        EXPECT_EQ(scale.max, one_scale.max) << what;
    }

    static Team *one_, *two_;
};
Team *SharedPictures::one_ = nullptr, *SharedPictures::two_ = nullptr;

TEST_F(SharedPictures, EqualOneDevicesForAllPacketsAndLanes) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const auto& [lanes, packet] : std::vector<std::pair<const char*, const char*>>{
             {"auto", "auto"}, {"1", "1x1"}, {"4", "3x5"}, {"8", "8x8"}, {"16", "16x16"}}) {
        const Settings settings = settings_of({{"lanes", lanes}, {"packet", packet}, {"size", "240x181"}, {"tone", "agx"}});
        expect_same(scene, settings, std::string(lanes) + " lanes, packet " + packet);
    }
    // As a GPU does it: one pixel per work-item.
    expect_same(scene, settings_of({{"lanes", "1"}, {"portable", "true"}, {"size", "160x120"}}), "groups of 64");
}

// Sums that were read after some samples, put back on the same or other devices, give the bits of a picture in one go.
TEST_F(SharedPictures, GoOnFromSumsOnOneDeviceAndOnSeveral) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const char* tracer : {"iterative", "path"}) {
        const Settings settings = settings_of({{"size", "200x131"}, {"spp", "5"}, {"tracer", tracer}, {"lanes", "8"}});
        const View view = make_view(*scene, 200.0f / 131);
        one_->trace(scene, settings, view, 0, 5);
        const FloatImage whole = one_->frames.read_values();
        for (Team* from : {one_, two_}) {
            from->trace(scene, settings, view, 0, 2);
            const auto sums = std::make_shared<const FloatImage>(from->frames.read_sums());
            const size_t plane = size_t(200) * 131 * 4;
            ASSERT_EQ(sums->pixels.size(), plane * from->frames.planes());
            for (size_t i = 3; i < plane; i += 4) ASSERT_EQ(sums->pixels[i], 2.0f) << "samples of a pixel";
            for (Team* to : {one_, two_}) {
                // Another picture in the film must leave no trace.
                to->trace(scene, settings_of({{"size", "300x200"}}), view, 0, 3);
                to->frames.resume(to->preparer.prepare(scene, settings, to->progress), settings, sums, 2);
                to->trace(scene, settings, view, 2, 1);
                to->trace(scene, settings, view, 3, 2);
                EXPECT_EQ(to->frames.samples(), 5u);
                const std::string what =
                    std::string(tracer) + ", " + (from == one_ ? "one" : "two") + " to " + (to == one_ ? "one" : "two");
                EXPECT_EQ(differing(to->frames.read_values().pixels, whole.pixels), 0u) << what;
            }
        }
    }
}

TEST_F(SharedPictures, PathsAreEqualOneDevices) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const auto& [lanes, packet] : std::vector<std::pair<const char*, const char*>>{{"8", "8x8"}, {"4", "3x5"}})
        expect_same(scene, settings_of({{"tracer", "path"}, {"lanes", lanes}, {"packet", packet}, {"size", "120x91"}}),
                    std::string("path, ") + lanes + " lanes, packet " + packet, 3);
}

// Pictures that take less than 2 ms may be traced by one device of several, and by all of them again.
TEST_F(SharedPictures, AreTheSameWhereOneDeviceTracesThemAlone) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Settings settings = settings_of({{"size", "48x33"}});
    const View view = make_view(*scene, 48.0f / 33);
    one_->trace(scene, settings, view, 0, 3);
    unsigned alone = 0, together = 0;
    for (unsigned picture = 0; picture < 300 && (alone < 4 || together < 4); ++picture) {
        const FrameStats stats = two_->trace(scene, settings, view, 0, 1);
        ASSERT_EQ(two_->frames.samples(), 1u);
        ASSERT_EQ(stats.devices.size(), 2u);
        ++(stats.devices[0].share == 0 || stats.devices[1].share == 0 ? alone : together);
        if (alone == 0) continue;
        // Later samples go on with it.
        two_->trace(scene, settings, view, 1, 2);
        ASSERT_EQ(two_->frames.samples(), 3u);
        compare_films(settings, "picture " + std::to_string(picture));
    }
    EXPECT_GE(alone, 4u) << "of pictures that take so little";
    EXPECT_GE(together, 4u);
}

TEST_F(SharedPictures, EqualOneDevicesForOddSizes) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const char* size : {"1x1", "3x17", "17x3", "33x31", "40x33", "1x300"})
        expect_same(scene, settings_of({{"size", size}}), size);
}

// Tone mapping works on four pixels at a time. Here the pixels of a work-group row are no multiple of 4.
TEST_F(SharedPictures, EqualOneDevicesForRowsThatAreNoMultipleOfFour) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const char* packet : {"5x5", "3x3", "7x1", "1x5"})
        for (const char* size : {"102x96", "101x77", "255x64", "1022x48", "3x200"}) {
            const std::string what = std::string(size) + ", packet " + packet;
            const Settings settings = settings_of({{"packet", packet}, {"size", size}, {"depth", "1"}});
            expect_same(scene, settings, what);
            // After a picture was displayed, each device copies its rows of the next one during trace().
            expect_same(scene, settings, what + ", shown before", 2);
            for (const char* aov : {"t", "uv"})
                expect_same(scene, settings_of({{"packet", packet}, {"size", size}, {"aov", aov}}), what + ", " + aov);
        }
}

TEST_F(SharedPictures, EqualOneDevicesForManySamplesAtOnceOrOneByOne) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Settings settings = settings_of({{"size", "160x120"}});
    expect_same(scene, settings, "5 at once", 5);
    const View view = make_view(*scene, 160.0f / 120.0f);
    for (unsigned sample = 0; sample < 5; ++sample) EXPECT_EQ(two_->trace(scene, settings, view, sample).samples, sample + 1);
    compare_films(settings, "5 one by one");
    two_->trace(scene, settings, view, 0, 2);
    two_->trace(scene, settings, view, 2, 3);
    compare_films(settings, "2 and 3");
}

TEST_F(SharedPictures, EqualOneDevicesForAovs) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const char* aov : {"t", "prim", "normal", "steps", "generations"})  // one of each form of film
        expect_same(scene, settings_of({{"aov", aov}, {"size", "120x90"}}), aov);
}

TEST_F(SharedPictures, EqualOneDevicesForEveryTracer) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const std::string& tracer : find_setting("tracer")->choices)
        expect_same(scene, settings_of({{"tracer", tracer}, {"size", "160x120"}}), tracer, 3);
}

TEST_F(SharedPictures, TheStructureIsBuiltOnce) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Settings settings = settings_of({});
    const auto prepared = two_->preparer.prepare(scene, settings, two_->progress);
    ASSERT_EQ(prepared->parts.size(), 2u);
    EXPECT_EQ(prepared->parts[0].prepared->accel, prepared->parts[1].prepared->accel);
    EXPECT_NE(prepared->parts[0].prepared->on_device, prepared->parts[1].prepared->on_device);
    // Nothing is built, uploaded or compiled again without need.
    const auto again = two_->preparer.prepare(scene, settings_of({{"depth", "2"}}), two_->progress);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(again->parts[i].prepared->accel, prepared->parts[i].prepared->accel);
        EXPECT_EQ(again->parts[i].prepared->on_device, prepared->parts[i].prepared->on_device);
        EXPECT_EQ(again->parts[i].prepared->program, prepared->parts[i].prepared->program);
    }
}

// A whole CPU and a part of it are of different kinds, so at first their speeds are not known.
TEST_F(SharedPictures, DevicesMayBeOfDifferentKinds) {
    Team unlike("cpu,cpu/2.0");
    ASSERT_EQ(unlike.devices.size(), 2u);
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Settings settings = settings_of({{"size", "240x180"}});
    const View view = make_view(*scene, 240.0f / 180.0f);
    one_->trace(scene, settings, view, 0, 2);
    for (int picture = 0; picture < 3; ++picture) {
        unlike.trace(scene, settings, view, 0, 2);
        EXPECT_EQ(differing(one_->frames.read_values().pixels, unlike.frames.read_values().pixels), 0u) << picture;
    }
}

// As GPUs do it: a launch traces several samples, as soon as these are known to be short.
TEST_F(SharedPictures, ALaunchMayTraceSeveralSamples) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene")),
                   plain = load_scene(source_file("scenes/spheres21.scene"));
    for (const ScenePtr& of : {scene, plain})
        for (const char* tracer : {"iterative", "wavefront"}) {
            const auto with = [&](const char* packet) {
                return settings_of(
                    {{"lanes", "1"}, {"packet", packet}, {"portable", "true"}, {"tracer", tracer}, {"size", "32x25"}});
            };
            const View view = make_view(*of, 32.0f / 25.0f);
            // Packets of 2x1 are traced one sample per launch.
            const FrameStats truth = one_->trace(of, with("2x1"), view, 0, 21);
            const FloatPixels pixels = one_->frames.read_values().pixels, distance = one_->frames.read_distance().pixels;
            EXPECT_GE(truth.launches, 21u);
            for (Team* team : {one_, two_})
                for (int picture = 0; picture < 3; ++picture) {
                    FrameStats stats = team->trace(of, with("1x1"), view, 0, 9);
                    add_stats(stats, team->trace(of, with("1x1"), view, 9, 12));
                    EXPECT_EQ(differing(pixels, team->frames.read_values().pixels), 0u) << tracer << picture;
                    EXPECT_EQ(differing(distance, team->frames.read_distance().pixels), 0u) << tracer << picture;
                    EXPECT_EQ(stats.samples, 21u);
                    // The first picture measures the time of a sample. Wavefront traces one sample per launch if rays split.
                    const bool together = picture == 2 && (of == plain || std::string(tracer) == "iterative");
                    EXPECT_TRUE(!together || stats.launches < 21 * team->devices.size()) << tracer << stats.launches;
                    EXPECT_EQ(stats.primary, truth.primary) << tracer << picture;
                    EXPECT_EQ(stats.shadow, truth.shadow) << tracer << picture;
                    EXPECT_EQ(stats.secondary, truth.secondary) << tracer << picture;
                }
        }
}

// After a picture was displayed, the next one is copied to the host during trace().
TEST_F(SharedPictures, ConsecutiveDisplaysAreRight) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    Settings settings = settings_of({{"size", "160x121"}});
    for (int picture = 0; picture < 4; ++picture) {
        const View view = make_view(*scene, 160.0f / 121.0f, picture == 2 ? "1,2,6,0,0,0" : "");
        FrameStats stats;
        for (Team* team : {one_, two_}) stats = team->trace(scene, settings, view, 0, 3);
        if (picture == 3) settings.exposure = 2;
        const ByteImage shared = two_->frames.read_display(settings, &stats);
        EXPECT_TRUE(one_->frames.read_display(settings).pixels == shared.pixels) << picture;
        for (const DeviceShare& share : stats.devices) EXPECT_EQ(share.tone_map_ms > 0, share.share > 0) << picture;
        EXPECT_TRUE(shared.pixels == two_->frames.read_display(settings).pixels) << picture << ": once more";
    }
}

// Cancels after this fraction of the samples.
class StopAfter : public Progress {
 public:
    explicit StopAfter(float fraction) : fraction_(fraction) {}
    bool report(float fraction) override {
        if (fraction >= fraction_) cancel();
        return !cancelled();
    }

 private:
    const float fraction_;
};

TEST_F(SharedPictures, ACancelledPictureKeepsItsCompleteSamples) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Settings settings = settings_of({{"size", "160x120"}});
    const View view = make_view(*scene, 160.0f / 120.0f);
    const auto prepared = two_->preparer.prepare(scene, settings, two_->progress);
    StopAfter at_once(0.0f), later(0.19f);
    at_once.cancel();
    EXPECT_THROW(two_->frames.trace(prepared, settings, view, 0, false, at_once), Cancelled);
    EXPECT_EQ(two_->frames.samples(), 0u);
    EXPECT_THROW(two_->frames.trace(prepared, settings, view, 0, false, later, 50), Cancelled);
    // One device may have more samples than the other. Each pixel counts its own.
    const unsigned complete = two_->frames.samples();
    EXPECT_GE(complete, 1u);
    EXPECT_LT(complete, 50u);
    const FloatImage partial = two_->frames.read_values();
    one_->trace(scene, settings, view, 0, complete);
    const FloatImage whole = one_->frames.read_values();
    size_t far = 0;
    for (size_t i = 0; i < whole.pixels.size(); ++i) far += std::abs(whole.pixels[i] - partial.pixels[i]) > 0.5f;
    EXPECT_LT(far, whole.pixels.size() / 100);
    expect_same(scene, settings, "the next picture", 2);
}

}  // namespace
