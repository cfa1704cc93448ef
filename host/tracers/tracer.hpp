// tracer.hpp -- the interface of tracers: of pictures, and of whatever else traces rays through a scene. A tracer is a folder
// here and one of the same name in cl/tracers, with its kernels; tracers.inl has a row for each.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "device/device.hpp"
#include "kernels/program_cache.hpp"
#include "launch/launch.hpp"
#include "launch/prepared.hpp"
#include "launch/view_buffers.hpp"
#include "picture/film.hpp"
#include "picture/frame_stats.hpp"
#include "picture/overflow_counter.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {

// Work-groups [begin, begin + groups) of samples [sample, sample + samples) of a frame. If there are several samples, `groups`
// counts those of all, and `film` has a layer for each.
struct FrameLaunch {
    const Prepared& prepared;
    const Settings& settings;  // the frame's size and depth, and others that act at once
    const View& view;
    const ViewBuffers& buffers;  // with an rt_frame for each sample
    Queue& queue;
    const cl::Buffer &film, &distances;
    unsigned begin = 0, groups = 1, sample = 0;
};

// One program of a tracer of frames on one device, with the buffers that it needs besides the film. Used from one thread.
class FrameTracer {
 public:
    FrameTracer(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program)
        : device_(std::move(device)), program_(std::move(program)) {}
    virtual ~FrameTracer() = default;
    // Traces in pieces. `go_on` is called between pieces and stops the trace by throwing.
    virtual LaunchTimes trace(Launcher& launcher, const FrameLaunch& frame, const std::function<void()>& go_on,
                              const SideWork& side_work) = 0;
    // Whether a launch may trace several samples, each into a layer of its own.
    virtual bool takes_layers(const Prepared&, const View&) const { return program_->row.has(kLayers); }
    bool counts_rays() const { return program_->row.has(kCountsRays); }
    // Enqueues the sum of the last launch's ray counters, which end_count() waits for. Only if counts_rays().
    virtual cl::Event begin_count(FilmKernels& film) const = 0;
    // debug: the program checks its stacks. time: becomes that of the kernel. The result has no primary rays.
    RayCounts end_count(FilmKernels& film, KernelTime& time, bool debug) const;
    // How many traversal stacks of a debug program were full since the launch of work-group 0. Only if not counts_rays().
    virtual uint64_t overflows(Queue& queue) const = 0;

 protected:
    const std::shared_ptr<Device> device_;
    const std::shared_ptr<const TraceProgram> program_;
};

// What a worker has to try kernels on: a small scene whose arrays lie between guard pages.
struct Smoke {
    std::shared_ptr<Device> device;
    Prepared prepared;  // without a program. Its kernels check their stacks; the settings have the size of the frame
    View view;
    // Tells what kernels do next, in the past tense ("they traced a frame ..."), and how many seconds of processor time of all
    // threads it may take.
    std::function<void(const std::string& step, double limit_s)> say_step;
};

struct Tracer : TracerChoice {
    bool is_choice = false;  // users may choose it, by the setting `tracer`
    // Of tracers of frames: the kernel for these settings; settings.aov is one that the tracer makes. Others: null.
    const KernelRow& (*kernel)(const Settings& settings, const Layout& layout) = nullptr;
    // How well it suits; `auto` takes the tracer of the greatest. 0: not at all. Null: never.
    unsigned (*merit)(const DeviceInfo& device, const Scene& scene) = nullptr;
    // Opens a program of its kernel. Null: a launch is one kernel over all work-groups (tracers.cpp).
    std::unique_ptr<FrameTracer> (*open)(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program) = nullptr;
    // Runs its kernels in a worker. Throws Error if they fail. Null: as tracers of frames (smoke.hpp).
    void (*smoke)(const Smoke& smoke) = nullptr;
};

// One that makes no frames.
Tracer tracer_with(const char* id, void (*smoke)(const Smoke& smoke));

// All tracers, in the order of their rows.
const std::vector<const Tracer*>& tracers();
// Throws std::out_of_range.
const Tracer& find_tracer(std::string_view id);
// The tracer that makes frames of these settings: settings.tracer, which is not `auto`, or that of settings.aov.
const Tracer& tracer_of(const Settings& settings);
// What `auto` stands for.
const Tracer& automatic_tracer(const DeviceInfo& device, const Scene& scene);
std::unique_ptr<FrameTracer> open_tracer(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program);

}  // namespace clarity
