// reload_test.cpp -- a kernel is edited again and again. Each text must be the one that runs, and memory must not grow.
//
// CLARITY_RELOADS is the number of reloads to measure after the first 20. Use a multiple of 16, since the device is closed and
// opened again after 16 programs. The default is 16; 176 take some minutes.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;
namespace fs = std::filesystem;

namespace {

// Resident memory of this process.
double resident_mb() {
    std::ifstream in("/proc/self/statm");
    double all = 0, resident = 0;
    in >> all >> resident;
    return resident * double(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

// Heap memory in use. This is exact to the byte, while pages show only large changes.
double heap_mb() {
    const struct mallinfo2 info = mallinfo2();
    return double(info.uordblks + info.hblkhd) / (1 << 20);
}

// Edits a kernel and traces a small picture, repeatedly.
class Author {
 public:
    Author() {
        fs::copy(source_file("cl"), scratch_.path("cl"), fs::copy_options::recursive);
        environment_.set("CLARITY_KERNEL_PATH", scratch_.path("cl"));
        // Set before the first use of PoCL: kernels that an earlier run left in its cache would not be compiled.
        fs::create_directories(scratch_.path("pocl"));
        environment_.set("POCL_CACHE_DIR", scratch_.path("pocl"));
        sound_ = scratch_.read("cl/tracers/aov/aov.cl");
        plugins_ = PluginRegistry::discover();
        scene_ = shared_scene(scene_of(box(1)));
        settings_ = make_settings({{"accel", "bvh2"}, {"size", "8x8"}, {"aov", "t"}});
        view_ = view_from({0, 0, 5}, {0, 0, 0}, 20);  // the box is 4 away and fills the picture
        const auto device = std::make_shared<Device>(choose_device(""));
        preparer_ = std::make_unique<Preparer>(plugins_, device);
        frames_ = std::make_unique<FrameRenderer>(device);
    }
    // Multiplies distances by `number` in the kernel's text. Returns a value of the new picture.
    float distance_times(int number) {
        const std::string store = "RT_FOR_LANES_STORE(out, at, hit->t, bits)";
        std::string text = sound_;
        const size_t at = text.find(store);
        if (at == std::string::npos) throw std::runtime_error("aov.cl no longer has the line that this test edits: " + store);
        text.replace(at, store.size(), "RT_FOR_LANES_STORE(out, at, hit->t * " + std::to_string(number) + ".0f, bits)");
        scratch_.write("cl/tracers/aov/aov.cl", text);
        const std::shared_ptr<const AccelData> accel = prepared_ ? prepared_->accel : nullptr;
        if (preparer_->needs_reopen()) renew_device();
        prepared_ = preparer_->prepare(scene_, settings_, progress_);
        EXPECT_TRUE(!accel || prepared_->accel == accel) << "the structure was built again";
        EXPECT_FALSE(prepared_->compile_cached) << "edit " << number;
        frames_->trace(*prepared_, settings_, view_, 0, false, progress_);
        return frames_->read_values().pixels.at(8 * 4 + 4);
    }

 private:
    // Closes and opens the device as `render --watch` does.
    void renew_device() {
        const std::weak_ptr<const TraceProgram> program = prepared_->program;
        const std::weak_ptr<const DeviceScene> on_device = prepared_->on_device;
        frames_.reset();
        prepared_.reset();
        const DeviceInfo info = preparer_->close_device();
        EXPECT_TRUE(program.expired() && on_device.expired());
        const auto device = std::make_shared<Device>(info);
        preparer_->open_device(device);
        frames_ = std::make_unique<FrameRenderer>(device);
    }

    Scratch scratch_;
    Environment environment_;
    std::string sound_;
    PluginRegistry plugins_;
    ScenePtr scene_;
    Settings settings_;
    View view_;
    Progress progress_;
    std::unique_ptr<Preparer> preparer_;
    std::shared_ptr<const Prepared> prepared_;
    std::unique_ptr<FrameRenderer> frames_;
};

TEST(Reload, RunsEachNewTextWithoutGrowingMemory) {
    constexpr int kFirst = 20;
    const char* wished = std::getenv("CLARITY_RELOADS");
    const int count = wished ? std::max(1, std::atoi(wished)) : 16;
    Author author;
    const float distance = author.distance_times(1);
    EXPECT_NEAR(distance, 4, 0.2);
    for (int i = 2; i <= kFirst; ++i) ASSERT_FLOAT_EQ(author.distance_times(i), distance * float(i));
    const double before = resident_mb(), heap_before = heap_mb();
    for (int i = kFirst + 1; i <= kFirst + count; ++i) {
        ASSERT_FLOAT_EQ(author.distance_times(i), distance * float(i));
        if (i % 4 == 0) std::printf("%4d reloads: %.1f MB resident, %.2f MB of heap\n", i, resident_mb(), heap_mb());
    }
    const double after = resident_mb(), heap_after = heap_mb();
    EXPECT_LT(after, 1.05 * before) << "resident, MB";
    // If PoCL keeps a program, that takes up to a megabyte.
    EXPECT_LT((heap_after - heap_before) / count, 0.05) << "MB of heap a reload";
}

}  // namespace
