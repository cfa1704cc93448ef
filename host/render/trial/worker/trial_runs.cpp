#include "render/trial/worker/trial_runs.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <list>
#include <optional>
#include <random>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "render/film/film.hpp"
#include "render/frame/frame_renderer.hpp"
#include "render/frame/preparer.hpp"
#include "render/settings/view.hpp"
#include "render/tracers/inspect/inspect.hpp"
#include "render/tracers/rays/query_scene.hpp"
#include "render/tracers/rays/ray_blocks.hpp"
#include "render/tracers/rays/ray_queries.hpp"
#include "render/trial/trial.hpp"
#include "render/trial/worker/guarded_accel.hpp"
#include "render/trial/worker/trial_scene.hpp"

namespace clarity {
namespace {

// Limits in seconds of processor time. A frame of this size takes a few milliseconds.
constexpr double kBuildLimit_s = 30, kCompileLimit_s = 3600, kRunLimit_s = 4;
constexpr int kWidth = 64, kHeight = 48, kDepth = 5;
const std::string kFrame = std::to_string(kWidth) + "x" + std::to_string(kHeight);

// The first launch of a program may generate code for it, which takes longer for programs that took longer to compile.
class TrialProgress : public Progress {
 public:
    explicit TrialProgress(const TrialSteps& say_step) : say_step_(say_step) {}
    void stage(const std::string& text) override {
        if (text == kFirstLaunchStage)
            say_step_("they were launched for the first time, on one pixel", kRunLimit_s + 3 * seconds_since(begin_));
        else
            say_step_(text, text.find("building") == 0 ? kBuildLimit_s : kCompileLimit_s);
        begin_ = std::chrono::steady_clock::now();
    }

 private:
    const TrialSteps& say_step_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Compiles a program, which the driver then has in its cache. Returns the limit for its first run: it may generate code, or
// compile once more.
double compiled_first(const Prepared& prepared, KernelKind kind, const std::shared_ptr<Device>& device,
                      const TrialSteps& say_step) {
    say_step("compiling kernels", kCompileLimit_s);
    const auto begin = std::chrono::steady_clock::now();
    ProgramCache(device).get(kernel_for(prepared, kind));
    return kRunLimit_s + 4 * seconds_since(begin);
}

void expect_room_on_stacks(uint64_t overflowed, const std::string& meanwhile) {
    if (overflowed > 0)
        throw Error(Exit::kernel_build_failed, "would have written beyond a traversal stack: " + std::to_string(overflowed) +
                                                   " times a stack was full while they " + meanwhile);
}

void try_frame(Preparer& preparer, const std::shared_ptr<const Scene>& scene, const Settings& settings,
               std::shared_ptr<const AccelData> accel, const std::shared_ptr<Device>& device, TrialProgress& progress,
               const TrialSteps& say_step) {
    const auto prepared = preparer.prepare(scene, settings, progress, std::move(accel));
    say_step("they traced a frame of " + kFrame + " of a small scene", kRunLimit_s);
    FrameRenderer renderer(device);
    const View view = make_view(*scene, float(kWidth) / float(kHeight));
    const FrameStats stats = renderer.trace(*prepared, prepared->settings, view, Samples(0), true, progress);
    expect_room_on_stacks(stats.overflowed, "traced a small scene");
}

void try_pixels(const Prepared& prepared, const Scene& scene, const std::shared_ptr<Device>& device,
                const TrialSteps& say_step) {
    constexpr const char* what = "recorded the rays of some pixels";
    double limit_s = compiled_first(prepared, KernelKind::inspect, device, say_step);
    Inspector inspector(device);
    const View view = make_view(scene, float(kWidth) / float(kHeight));
    for (unsigned y = 4; y < kHeight; y += 8)
        for (unsigned x = 4; x < kWidth; x += 8) {
            say_step(std::string("they ") + what, limit_s);
            limit_s = kRunLimit_s;
            expect_room_on_stacks(inspector.trace(prepared, prepared.settings, view, x, y).overflowed, what);
        }
}

// Rays from around and inside the scene, some of them beside each other, some along an axis.
std::vector<rt_ray> trial_rays() {
    constexpr size_t kCount = 1000;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> among(-1, 1);
    std::vector<rt_ray> rays(kCount);
    for (size_t i = 0; i < kCount; ++i) {
        rt_ray& ray = rays[i];
        float length = 0;
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis] = (i % 2 ? 7.0f : 1.5f) * among(random);
            ray.direction[axis] = i % 2 ? 2 * among(random) - ray.origin[axis] : among(random);
            length += ray.direction[axis] * ray.direction[axis];
        }
        for (float& d : ray.direction) d /= std::sqrt(std::max(length, 1e-6f));
        if (i % 20 == 0)
            for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = axis == int(i / 20 % 3) ? 1.0f : 0.0f;
        if (i % 7 == 0 && i > 0) ray.origin[0] = rays[i - 1].origin[0];
        ray.t_min = 1e-4f;
        ray.t_max = i % 5 ? INFINITY : 3.0f;
    }
    return rays;
}

void try_rays(const Prepared& prepared, KernelKind kind, const std::shared_ptr<Device>& device, const TrialSteps& say_step) {
    const double limit_s = compiled_first(prepared, kind, device, say_step);
    const RayBlocks rays(trial_rays(), prepared.layout.lanes);
    const std::string what = "traced " + std::to_string(rays.ray_count()) + " rays of a query";
    RayQueries queries(device);
    for (const bool any_hit : {false, true}) {
        constexpr int kMostRuns = 24;  // the autotuner has tried each variant before
        RayQuery query;
        query.any_hit = any_hit;
        query.count = kind == KernelKind::counted_rays;
        for (int run = 0; run < kMostRuns; ++run) {
            say_step("they " + what, limit_s);
            std::vector<rt_hit> hits;
            queries.trace(prepared, rays, query, &hits);
            expect_room_on_stacks(queries.overflows(), what);
            if (queries.tuning().settled) break;
        }
    }
}

// Between guard pages, which kernels on a CPU see.
cl::Buffer guarded_buffer(Device& device, std::list<GuardedBytes>& memory, const char* name, size_t bytes) {
    GuardedBytes& block = memory.emplace_back(bytes, name);
    return {device.context(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, block.data()};
}

}  // namespace

std::string try_on_small_scene(const TrialArguments& arguments, const PluginRegistry& plugins,
                               const std::shared_ptr<Device>& device, const TrialSteps& say_step) {
    std::vector<ShapeKind> kinds;
    for (const TrialShape& shape : arguments.shapes) {
        const auto same = [&](const ShapeKind& kind) { return kind.id == shape.id; };
        if (std::any_of(kinds.begin(), kinds.end(), same)) continue;
        kinds.push_back({shape.id, plugins.primitive(shape.id)});
        if (!kinds.back().plugin) return "there is no plugin for shapes `" + shape.id + "`";
    }
    const auto scene = std::make_shared<const Scene>(trial_scene(arguments.features, kinds, arguments.shapes));
    Settings settings = arguments.settings;
    settings.debug = true;  // stacks are checked
    settings.width = kWidth;
    settings.height = kHeight;
    settings.depth = std::min(settings.depth, kDepth);
    settings.spp = 1;
    settings.shutter = 0;
    TrialProgress progress(say_step);
    Preparer preparer(plugins, device);
    const GuardedAccel guarded(*preparer.build(scene, settings, progress));
    if (arguments.kind == TrialKind::frame) {
        try_frame(preparer, scene, settings, guarded.accel(), device, progress, say_step);
        return {};
    }
    const auto prepared = prepare_queries(*device, scene, guarded.accel(), settings, progress);
    if (arguments.kind == TrialKind::pixels)
        try_pixels(*prepared, *scene, device, say_step);
    else
        try_rays(*prepared, arguments.kind == TrialKind::counted_rays ? KernelKind::counted_rays : KernelKind::rays, device,
                 say_step);
    return {};
}

std::string try_film_kernels(const std::shared_ptr<Device>& device, const TrialSteps& say_step) {
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
        return std::string();
    });
}

}  // namespace clarity
