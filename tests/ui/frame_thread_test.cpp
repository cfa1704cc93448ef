// frame_thread_test.cpp -- tests the thread that traces, without a window. Every picture belongs to the job that it names,
// pictures arrive in order, the last one arrives, and no picture changes while someone holds it. Each test runs with a device
// that copies while it traces, as GPUs do (a CPU which claims to), and with one that does not.
#include "ui/threads/frame_thread.hpp"
#include "support/clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "support/faults.hpp"
#include "support/scenes.hpp"

namespace clarity::ui {
namespace {

using namespace test;

using Bytes = std::vector<uint8_t>;

Bytes bytes_of(const ByteImage& image) {
    return {image.pixels.begin(), image.pixels.end()};
}

// A scene prepared on a device, and another preparation of it.
struct Table {
    Table() {
        DeviceInfo info = choose_device("");
        info.cpu = false;
        info.gpu = true;
        gpu = std::make_shared<Device>(info);
        cpu = std::make_shared<Device>(choose_device(""));
    }
    std::shared_ptr<const Ready> ready(const std::shared_ptr<Device>& device, bool two) {
        const auto prepared = [&](const Settings& desired_now) {
            return std::make_shared<MultiPreparer>(Workbench::get().plugins(), Devices{device})
                ->prepare(scene, desired_now, progress);
        };
        auto ready = std::make_shared<Ready>();
        ready->main = ReadySide({device}, prepared(settings));
        if (two) ready->other = ReadySide({device}, prepared(other));
        return ready;
    }
    ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Settings settings = make_settings(
                       {{"accel", "bvh2"}, {"size", "96x72"}, {"lanes", "1"}, {"packet", "1x1"}, {"portable", "true"}}),
                   other = make_settings(
                       {{"accel", "linear"}, {"size", "96x72"}, {"lanes", "1"}, {"packet", "1x1"}, {"portable", "true"}});
    Progress progress;
    std::shared_ptr<Device> gpu, cpu;
};

Table& table() {
    static Table* const table =
        new Table;  // never destroyed, because OpenCL drivers may shut down before static objects are destroyed
    return *table;
}

class FrameThreads : public ::testing::TestWithParam<const char*> {
 protected:
    FrameThreads() : thread_([this] { news(); }) {
        device_ = std::string(GetParam()) == "cpu" ? table().cpu : table().gpu;
        two_ = std::string(GetParam()) == "gpu, compared";
        job_.ready = table().ready(device_, two_);
        job_.settings = table().settings;
        if (two_) job_.other_settings = table().other;
    }
    void TearDown() override { faults.end(); }

    // Keeps each new picture, with a copy of its bytes at the time of arrival.
    void news() {
        const auto picture = thread_.latest();
        const std::lock_guard<std::mutex> lock(mutex_);
        if (picture && (seen_.empty() || seen_.back().picture != picture))
            seen_.push_back(
                {picture, bytes_of(picture->main.image), picture->other ? bytes_of(picture->other->image) : Bytes()});
    }
    static View view(uint64_t number) {
        const float angle = 0.3f * float(number % 7);
        return make_view(*table().scene, 4.0f / 3,
                         std::to_string(9 * std::sin(angle)) + ",2.5," + std::to_string(9 * std::cos(angle)) + ",0,2.2,0,50");
    }
    void post(uint64_t number, bool continuous) {
        job_.revision = number;
        job_.view = view(number);
        job_.continuous = continuous;
        thread_.post(job_);
    }
    uint64_t newest() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return seen_.empty() ? 0 : seen_.back().picture->job.revision;
    }
    template <class Condition>
    bool wait_for(const Condition& condition) {
        return test::comes(condition);
    }
    // Waits until the thread is idle and has said so.
    bool settles() {
        return wait_for([this] {
            const bool idle = thread_.idle();
            const auto latest = thread_.latest();
            const std::lock_guard<std::mutex> lock(mutex_);
            return idle && !seen_.empty() && seen_.back().picture == latest;
        });
    }
    Bytes truth(const Picture& picture, const PictureSide& side, const ReadySide& ready) {
        if (!frames_) frames_ = std::make_unique<FrameRenderer>(device_);
        for (unsigned sample = 0; sample < side.stats.samples; ++sample)
            frames_->trace(*ready.loan->get()->prepared->first(), side.settings, picture.job.view, sample, false,
                           table().progress);
        return bytes_of(frames_->read_display(side.settings));
    }
    void expect_right(const Picture& picture) {
        const std::string what = "revision " + std::to_string(picture.job.revision);
        EXPECT_TRUE(bytes_of(picture.main.image) == truth(picture, picture.main, picture.job.ready->main)) << what;
        EXPECT_EQ(picture.other.has_value(), two_);
        if (!picture.other) return;
        EXPECT_TRUE(bytes_of(picture.other->image) == truth(picture, *picture.other, *picture.job.ready->other)) << what;
        EXPECT_TRUE(picture.difference.has_value());
    }
    // Checks all pictures that arrived; call it when the thread is idle.
    void expect_order() {
        uint64_t last = 0;
        for (const Seen& seen : seen_) {
            EXPECT_GE(seen.picture->job.revision, last);
            last = seen.picture->job.revision;
            EXPECT_TRUE(bytes_of(seen.picture->main.image) == seen.main) << "revision " << last << " changed";
            if (seen.picture->other) {
                EXPECT_TRUE(bytes_of(seen.picture->other->image) == seen.other) << "revision " << last << " changed";
            }
            expect_right(*seen.picture);
        }
    }

    struct Seen {
        std::shared_ptr<const Picture> picture;
        Bytes main, other;
    };
    std::shared_ptr<Device> device_;
    bool two_ = false;
    FrameJob job_;
    std::mutex mutex_;
    std::vector<Seen> seen_;
    std::unique_ptr<FrameRenderer> frames_;
    FrameThread thread_;
};

// A motion that always leaves something to trace, so that pictures overlap where the device can; then rest.
TEST_P(FrameThreads, ShowEveryPictureOfAMotionAndTheLastOne) {
    for (const unsigned copy_ms : {0u, 20u}) {
        faults.copy_ms = copy_ms;
        const uint64_t first = newest() + 1;
        for (uint64_t number = first; number < first + 12; ++number) {
            post(number, true);
            ASSERT_TRUE(wait_for([&] { return newest() >= number; })) << number;
        }
        job_.settings.spp = 3;
        post(first + 12, false);
        ASSERT_TRUE(settles());
        ASSERT_TRUE(wait_for([&] { return newest() == first + 12; })) << "the last picture never comes";
        EXPECT_EQ(thread_.latest()->main.stats.samples, 3u);
    }
    expect_order();
    EXPECT_EQ(thread_.take_failure(), "");
}

// A finished picture that is traced again and again, to measure, stays on the screen. With fewer samples it would flicker.
TEST_P(FrameThreads, AFinishedPictureStaysWhileItIsMeasured) {
    job_.settings.spp = 4;
    if (two_) job_.other_settings->spp = 4;
    post(1, false);
    ASSERT_TRUE(settles());
    const Bytes finished = bytes_of(thread_.latest()->main.image);
    const size_t times = thread_.times().size();
    post(1, true);
    ASSERT_TRUE(wait_for([&] { return thread_.times().size() >= times + 10; }));
    post(1, false);
    ASSERT_TRUE(settles());
    EXPECT_EQ(thread_.latest()->main.stats.samples, 4u);
    EXPECT_TRUE(bytes_of(thread_.latest()->main.image) == finished);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        bool complete = false;
        for (const Seen& seen : seen_) {
            EXPECT_TRUE(!complete || seen.main == finished);
            complete |= seen.picture->main.stats.samples == 4;
        }
        EXPECT_TRUE(complete);
    }
    expect_order();
}

// Jobs posted faster than they can be traced, as a window does.
TEST_P(FrameThreads, JobsPostedFasterThanTheyAreTraced) {
    faults.copy_ms = 3;
    for (uint64_t number = 1; number <= 60; ++number) {
        post(number, false);
        std::this_thread::sleep_for(std::chrono::milliseconds(number % 4));
    }
    ASSERT_TRUE(settles());
    ASSERT_TRUE(wait_for([&] { return newest() == 60; })) << "the last picture never comes";
    expect_order();
}

// Size, exposure and requested distances change between two pictures.
TEST_P(FrameThreads, SettingsThatChangeBetweenPictures) {
    faults.copy_ms = 10;
    uint64_t number = 0;
    for (const auto& [width, height] : {std::pair{96, 72}, {200, 150}, {33, 31}, {64, 48}}) {
        job_.settings.width = width;
        job_.settings.height = height;
        if (two_) {
            job_.other_settings->width = width;
            job_.other_settings->height = height;
        }
        job_.settings.exposure += 0.25;
        thread_.want_distance(width == 33);
        post(++number, true);
        ASSERT_TRUE(wait_for([&] { return newest() >= number; }));
        EXPECT_TRUE(width != 33 || wait_for([&] { return thread_.latest()->main.distance != nullptr; }));
    }
    // A job that only displays the film again.
    post(++number, false);
    ASSERT_TRUE(settles());
    job_.settings.exposure = 0.5;
    ++job_.display_revision;
    thread_.post(job_);
    ASSERT_TRUE(settles());
    EXPECT_EQ(thread_.latest()->main.settings.exposure, 0.5);
    // Then another program; then the devices are taken away and given back.
    job_.ready = table().ready(device_, two_);
    post(++number, true);
    ASSERT_TRUE(wait_for([&] { return newest() == number; }));
    post(++number, true);
    thread_.release();
    const auto then = thread_.latest();
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(thread_.latest(), then) << "traced on after release()";
    thread_.resume();
    ASSERT_TRUE(wait_for([&] { return newest() == number; }));
    post(++number, false);
    ASSERT_TRUE(settles());
    ASSERT_TRUE(wait_for([&] { return newest() == number; }));
    expect_order();
}

// The sides of a comparison are traced and copied one after the other: the time of each is its own copy's and nobody else's.
TEST_P(FrameThreads, ComparedSidesAreTimedOneAfterTheOther) {
    if (!two_) GTEST_SKIP() << "one side";
    constexpr double kCopy_ms = 200, kCopies_ms = 2 * kCopy_ms;  // a side's frame copies its counters and its picture
    faults.copy_ms = static_cast<unsigned>(kCopy_ms);
    post(1, true);
    ASSERT_TRUE(wait_for([&] { return thread_.times(1).size() >= 6; }));
    post(1, false);
    ASSERT_TRUE(settles());
    for (const unsigned side : {0u, 1u}) {
        const FrameTimes times = thread_.times(side);
        const double least = double(*std::min_element(times.frames_ms().begin(), times.frames_ms().end()));
        EXPECT_GE(least, kCopies_ms * 0.98) << side << ": one of its copies is not counted";
        EXPECT_LT(least, clocks_count() ? kCopies_ms + kCopy_ms * 0.9 : 1e3 * kHangs_s)
            << side << ": another's copy is counted";
        // By the device's clock the wait for other things is no work.
        ASSERT_EQ(times.kernels_ms().size(), times.size());
        EXPECT_LT(double(*std::min_element(times.kernels_ms().begin(), times.kernels_ms().end())),
                  clocks_count() ? kCopy_ms : 1e3 * kHangs_s);
        EXPECT_GT(double(times.kernels_ms().front()), 0);
    }
}

// Device work that fails at any point of two pictures: there is a message, and the next picture is right.
TEST_P(FrameThreads, FailingDeviceWork) {
    uint64_t number = 1;
    post(number, true);
    ASSERT_TRUE(wait_for([&] { return newest() == 1; }));
    for (std::atomic<int>* const left : {&faults.launches_left, &faults.copies_left})
        for (int launch = 0; launch < 6; ++launch) {
            *left = launch;
            post(++number, true);
            std::string failure;
            EXPECT_TRUE(wait_for([&] { return !(failure = thread_.take_failure()).empty(); }));
            EXPECT_NE(failure.find(device_->info().name), std::string::npos) << failure;
            faults.end();
            post(++number, true);
            ASSERT_TRUE(wait_for([&] { return newest() == number; })) << launch;
        }
    post(++number, false);
    ASSERT_TRUE(settles());
    ASSERT_TRUE(wait_for([&] { return newest() == number; }));
    EXPECT_EQ(thread_.take_failure(), "");
    expect_order();
}

INSTANTIATE_TEST_SUITE_P(Devices, FrameThreads, ::testing::Values("cpu", "gpu", "gpu, compared"));

}  // namespace
}  // namespace clarity::ui
