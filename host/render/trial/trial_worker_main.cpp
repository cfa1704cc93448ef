// trial_worker_main.cpp -- main function of the worker process that tries kernels.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <list>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/log.hpp"
#include "plugin/registry.hpp"
#include "render/accel/guarded_memory.hpp"
#include "render/frame/frame_renderer.hpp"
#include "render/frame/preparer.hpp"
#include "render/settings/view.hpp"
#include "render/trial/trial.hpp"
#include "render/trial/trial_arguments.hpp"
#include "render/trial/trial_scene.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity {
namespace {

using worker::MessageKind;

// Limits in seconds of processor time, of all threads. A frame of this size takes a few milliseconds.
constexpr double kBuildLimit_s = 30, kCompileLimit_s = 3600, kTraceLimit_s = 4;
constexpr int kWidth = 64, kHeight = 48, kDepth = 5;

void say_step(const std::string& step, double limit_s) {
    worker::take_crash_signals();
    worker::send_message(worker::kChannelFd, {MessageKind::running, 0, static_cast<float>(limit_s), step});
}

// The first launch of a program may generate code for it, which takes longer for programs that took longer to compile.
class TrialProgress : public Progress {
 public:
    void stage(const std::string& text) override {
        if (text == kFirstLaunchStage)
            say_step("they were launched for the first time, on one pixel", kTraceLimit_s + 3 * seconds_since(begin_));
        else
            say_step(text, text.find("building") == 0 ? kBuildLimit_s : kCompileLimit_s);
        begin_ = std::chrono::steady_clock::now();
    }

 private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// The structure with its arrays between guard pages, which kernels on a CPU read in place.
class GuardedAccel {
 public:
    explicit GuardedAccel(const AccelData& built) {
        const auto guarded = [&](const AlignedBytes& from, const std::string& name) {
            GuardedBytes& copy = memory_.emplace_back(from.bytes(), name);
            if (from.bytes() > 0) std::memcpy(copy.data(), from.data(), from.bytes());
            copy.make_read_only();
            return AlignedBytes::borrow(copy.data(), copy.bytes());
        };
        accel_ = std::make_shared<AccelData>();
        AccelData& a = *accel_;
        a.plugin = built.plugin;
        a.layout = built.layout;
        a.params = built.params;
        a.leaf_count = built.leaf_count;
        a.roots = built.roots;
        a.defines = built.defines;
        a.stats = built.stats;
        a.instances = built.instances;
        a.scene = built.scene;
        a.bytes = built.bytes;
        for (size_t i = 0; i < built.slots.size(); ++i) {
            AccelData::Slot slot;
            slot.memory = guarded(built.slots[i].memory, std::string("the slot ") + built.layout->accel->slots[i].name);
            slot.count = built.slots[i].count;
            a.slots.push_back(std::move(slot));
        }
        a.leaves = guarded(built.leaves, "the leaves");
    }
    std::shared_ptr<const AccelData> accel() const { return accel_; }

 private:
    std::list<GuardedBytes> memory_;
    std::shared_ptr<AccelData> accel_;
};

// Returns why there is no trial; empty: the kernels have passed. Throws Error if they have not.
std::string try_on_small_scene(const TrialArguments& arguments) {
    std::vector<std::string> libraries;
    for (const auto& [loaded, original] : arguments.libraries) {
        if (loaded != original) note_private_copy(loaded, original);
        libraries.push_back(loaded);
    }
    const PluginRegistry plugins = PluginRegistry::of(libraries);
    std::shared_ptr<Device> device;
    try {
        device = std::make_shared<Device>(choose_device(arguments.device));
    } catch (const Error& e) {
        return e.what();
    }
    if (device->info().name != arguments.device_name)
        return "device " + arguments.device + " is " + device->info().name + " here";
    const auto scene = std::make_shared<const Scene>(trial_scene(arguments.features));
    Settings settings = arguments.settings;
    settings.debug = true;  // stacks are checked
    settings.width = kWidth;
    settings.height = kHeight;
    settings.depth = std::min(settings.depth, kDepth);
    settings.spp = 1;
    settings.shutter = 0;
    TrialProgress progress;
    Preparer preparer(plugins, device);
    const GuardedAccel guarded(*preparer.build(scene, settings, progress));
    const auto prepared = preparer.prepare(scene, settings, progress, guarded.accel());
    say_step("they traced a frame of " + std::to_string(kWidth) + "x" + std::to_string(kHeight) + " of a small scene",
             kTraceLimit_s);
    FrameRenderer renderer(device);
    const View view = make_view(*scene, float(kWidth) / float(kHeight));
    const FrameStats stats = renderer.trace(*prepared, prepared->settings, view, Samples(0), true, progress);
    if (stats.overflowed > 0)
        throw Error(Exit::kernel_build_failed,
                    "would have written beyond a traversal stack: " + std::to_string(stats.overflowed) +
                        " times a stack was full while they traced a small scene");
    return {};
}

}  // namespace

int trial_worker_main(int argc, char** argv) {
    constexpr const char* instead = "to try kernels, run `clarity check`";
    TrialArguments arguments;
    try {
        arguments = read_trial_arguments(argc, argv);
    } catch (const Error& e) {
        std::fprintf(stderr, "workers are started by clarity itself; %s (%s)\n", instead, e.what());
        return static_cast<int>(Exit::usage);
    }
    if (!worker::begin_worker(worker::kTrialGreeting, arguments.parent, instead)) return static_cast<int>(Exit::usage);
    worker::Message last{MessageKind::done, 0, 0, {}};
    try {
        for (const std::string& note : worker::enter_sandbox(worker::WorkerKind::driver, {}, {}, {}))
            log(LogLevel::debug, "trial worker: " + note);
        if (const std::string why = try_on_small_scene(arguments); !why.empty())
            worker::send_message(worker::kChannelFd, {MessageKind::report, 0, 0, why});
    } catch (const std::exception& e) {
        last.kind = MessageKind::failed;
        last.text = e.what();
    }
    std::fflush(nullptr);
    worker::send_message(worker::kChannelFd, last);
    _exit(last.kind == MessageKind::done ? 0 : 1);  // without destructors: a launch may still run
}

}  // namespace clarity
