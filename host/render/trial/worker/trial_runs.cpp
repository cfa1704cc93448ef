#include "render/trial/worker/trial_runs.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <list>
#include <optional>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "render/accel/accel_copy.hpp"
#include "render/accel/guarded_memory.hpp"
#include "render/frame/preparer.hpp"
#include "render/tracers/rays/query_scene.hpp"
#include "render/tracers/smoke.hpp"
#include "render/trial/worker/trial_scene.hpp"

namespace clarity {
namespace {

constexpr double kBuildLimit_s = 30;  // of processor time
constexpr int kWidth = 64, kHeight = 48, kDepth = 5;

class TrialProgress : public Progress {
 public:
    explicit TrialProgress(const TrialSteps& say_step) : say_step_(say_step) {}
    void stage(const std::string& text) override { say_step_(text, kBuildLimit_s); }

 private:
    const TrialSteps& say_step_;
};

// A copy of a structure whose arrays lie between guard pages. Kernels on a CPU read them in place.
std::shared_ptr<const AccelData> guarded(const AccelData& built, std::list<GuardedBytes>& memory) {
    const rt_accel& accel = *built.layout->accel;
    rt_u32 slot = 0;
    return std::make_shared<const AccelData>(copy_of(built, [&](const AlignedBytes& from) {
        const std::string name = slot < accel.slot_count ? std::string("the slot ") + accel.slots[slot].name : "the leaves";
        ++slot;
        GuardedBytes& copy = memory.emplace_back(from.bytes(), name);
        if (from.bytes() > 0) std::memcpy(copy.data(), from.data(), from.bytes());
        copy.make_read_only();
        return AlignedBytes::borrow(copy.data(), copy.bytes());
    }));
}

// Between guard pages, which kernels on a CPU see.
cl::Buffer guarded_buffer(Device& device, std::list<GuardedBytes>& memory, const char* name, size_t bytes) {
    GuardedBytes& block = memory.emplace_back(bytes, name);
    return {device.context(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, block.data()};
}

}  // namespace

Problem try_on_small_scene(const TrialJob& job, const PluginRegistry& plugins, const std::shared_ptr<Device>& device,
                           const TrialSteps& say_step) {
    std::vector<ShapeKind> kinds;
    for (const TrialShape& shape : job.shapes) {
        const auto same = [&](const ShapeKind& kind) { return kind.id == shape.id; };
        if (std::any_of(kinds.begin(), kinds.end(), same)) continue;
        kinds.push_back({shape.id, plugins.primitive(shape.id)});
        if (!kinds.back().plugin) return "there is no plugin for shapes `" + shape.id + "`";
    }
    const auto scene = std::make_shared<const Scene>(trial_scene(job.features, kinds, job.shapes));
    Settings settings = job.settings;
    settings.debug = true;  // stacks are checked
    settings.optics = job.features.optics;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.crop = {};
    settings.depth = std::min(settings.depth, kDepth);
    settings.spp = 1;
    settings.shutter = 0;
    TrialProgress progress(say_step);
    Preparer preparer(plugins, device);
    std::list<GuardedBytes> memory;  // outlives all that uses the structure
    const auto accel = guarded(*preparer.build(scene, settings, progress), memory);
    const auto prepared = prepare_queries(*device, scene, accel, settings, progress);
    const Smoke smoke{device, *prepared, make_view(*scene, float(kWidth) / float(kHeight)), say_step};
    const Tracer& tracer = find_tracer(job.kernels);
    if (tracer.smoke)
        tracer.smoke(smoke);
    else
        smoke_frames(tracer, smoke);
    return {};
}

Problem try_film_kernels(const std::shared_ptr<Device>& device, const TrialSteps& say_step) {
    say_step("compiling kernels", kCompileLimit_s);
    const auto begin = std::chrono::steady_clock::now();
    std::optional<FilmKernels> kernels;
    try {
        kernels.emplace(device);
    } catch (const Error& e) {  // the process that asked for the trial says so itself
        return e.what();
    }
    FilmKernels& film = *kernels;
    const double limit_s = kRunLimit_s + 3 * seconds_since(begin);
    constexpr unsigned kPixels = kWidth * kHeight, kLayers = 3, kRows = 6;
    std::list<GuardedBytes> memory;
    return wrap_cl_errors(*device, "trying the film", [&] {
        const auto buffer = [&](const char* name, size_t bytes) { return guarded_buffer(*device, memory, name, bytes); };
        const cl::Buffer sums = buffer("the film", kPixels * 4 * sizeof(float)), display = buffer("the display", kPixels * 4),
                         layers = buffer("the layers", kLayers * kPixels * 4 * sizeof(float)),
                         counters = buffer("the counters", kPixels * 4 * sizeof(uint64_t));
        const std::vector<rt_u32> rows{0, 2, kRows - 1};
        const GroupRows some{kWidth, kHeight, kHeight / kRows, rows};
        std::vector<uint8_t> rgba(kPixels * 4);
        std::vector<KernelTime> times(1);
        const auto run = [&](const char* what, const auto& enqueue) {
            say_step(std::string("they ") + what, limit_s);
            enqueue();
            device->queue().finish();
        };
        run("added layers to the film", [&] { film.add_layers(sums, layers, kLayers, true, some); });
        for (const std::string& tone : tone_names()) {
            Settings settings;
            settings.tone = tone;
            run("mapped tones", [&] { film.map_tones(sums, display, kPixels, settings); });
            run("mapped tones of some rows", [&] {
                film.begin_rows(sums, some, settings, rgba.data());
                film.end_rows(times);
            });
        }
        for (const auto width : {FilmKernels::CounterWidth::bits32, FilmKernels::CounterWidth::bits64})
            run("added up counters", [&] {
                film.begin_sum(counters, kPixels, width);
                film.end_sum(times.front());
            });
        return Problem();
    });
}

}  // namespace clarity
