#include "tracers/smoke.hpp"

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"
#include "launch/frame_constants.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

// What a launch of a frame uses.
struct SmallFrame {
    std::shared_ptr<const Prepared> prepared;
    std::unique_ptr<FrameTracer> tracer;
    Queue queue;
    cl::Buffer film, distances;
    ViewBuffers buffers;
    Launcher launcher;

    void trace(const std::shared_ptr<Device>& device, const Settings& settings, const View& view) {
        const Layout& layout = prepared->layout;
        const auto width = static_cast<unsigned>(settings.width), height = static_cast<unsigned>(settings.height);
        const auto buffer = [&](size_t bytes) {
            return cl::Buffer(device->context(), CL_MEM_READ_WRITE, std::max<size_t>(bytes, 4096));
        };
        queue = Queue(device->context(), device->info().cl_device, true);
        film = buffer(size_t(width) * height * find_aov(settings.aov).film_channels() * sizeof(float) *
                      film_planes(prepared->program->row));
        distances = buffer(layout.packets(width, height) * layout.rays() * sizeof(float));
        buffers.write(queue, *prepared->scene, *prepared->on_device, {make_frame(view, settings, layout, *prepared->accel, 0)},
                      view);
        if (prepared->program->row.has(kPicksLights))
            buffers.write_emitters(queue, *prepared->scene, prepared->accel, view, prepared->settings);
        tracer = open_tracer(device, prepared->program);
        const unsigned groups = layout.groups_x(width) * layout.groups_y(height);
        const FrameLaunch frame{*prepared, settings, view, buffers, queue, film, distances, 0, groups, 0};
        tracer->trace(launcher, frame, [] {}, {});
    }
};

}  // namespace

void launch_first(const std::shared_ptr<Device>& device, const std::shared_ptr<const Prepared>& prepared) {
    const auto pixel = std::make_shared<SmallFrame>();
    pixel->prepared = prepared;
    Settings tiny = prepared->settings;
    tiny.width = tiny.height = tiny.depth = 1;
    View view;
    view.camera.eye = {0, 0, 1e6f};
    try {
        pixel->trace(device, tiny, view);
    } catch (...) {
        if (device->loss()->stuck()) never_release(pixel);
        throw;
    }
}

double compile_first(const Smoke& smoke, const KernelRow& row) {
    smoke.say_step("compiling kernels", kCompileLimit_s);
    const double begin_ms = processor_ms();
    ProgramCache(smoke.device).get(kernel_for(smoke.prepared, row));
    return kRunLimit_s + 4e-3 * (processor_ms() - begin_ms);
}

void expect_room_on_stacks(uint64_t overflowed, const std::string& meanwhile) {
    if (overflowed > 0)
        throw Error(Exit::kernel_build_failed, "would have written beyond a traversal stack: " + std::to_string(overflowed) +
                                                   " times a stack was full while they " + meanwhile);
}

void smoke_frames(const Tracer& tracer, const Smoke& smoke) {
    auto prepared = std::make_shared<Prepared>(smoke.prepared);
    const KernelRow& row = tracer.kernel(prepared->settings, prepared->layout);
    const double first_limit_s = compile_first(smoke, row);
    FilmKernels film(smoke.device);
    ProgramCache programs(smoke.device);
    prepared->program = programs.get(kernel_for(*prepared, row));
    smoke.say_step("they were launched for the first time, on one pixel", first_limit_s);
    wrap_cl_errors(*smoke.device, "trying kernels", [&] {
        launch_first(smoke.device, prepared);
        const Settings& settings = prepared->settings;
        smoke.say_step("they traced a frame of " + std::to_string(settings.width) + "x" + std::to_string(settings.height) +
                           " of a small scene",
                       kRunLimit_s);
        SmallFrame frame;
        frame.prepared = prepared;
        frame.trace(smoke.device, settings, smoke.view);
        uint64_t overflowed = 0;
        if (frame.tracer->counts_rays()) {
            KernelTime time;
            frame.tracer->begin_count(film);
            overflowed = frame.tracer->end_count(film, time, true).overflowed;
        } else {
            overflowed = frame.tracer->overflows(frame.queue);
        }
        expect_room_on_stacks(overflowed, "traced a small scene");
    });
}

}  // namespace clarity
