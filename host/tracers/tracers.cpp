#include <stdexcept>

#include "tracers/tracer.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

// Tracers of frames that launch one kernel over the groups of packets. Sets the arguments that the kernel declares,
// by their names: `frame`, `first_group`, `film` and the scene's; with kCountsRays also `counters` (shadow rays, secondary
// rays, dropped rays, full stacks of each packet, 32 bits each) and `distances`; without, RT_OVERFLOWS_PARAM.
class OneKernel : public FrameTracer {
 public:
    OneKernel(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program)
        : FrameTracer(std::move(device), std::move(program)), kernel_(program_->kernel()) {}

    LaunchTimes trace(Launcher& launcher, const FrameLaunch& frame, const std::function<void()>& go_on,
                      const SideWork& side_work) override {
        const Layout& layout = frame.prepared.layout;
        kernel_.set("film", frame.film);
        counted_ = (frame.begin + frame.groups) * layout.group_packets();
        if (counts_rays()) {
            const size_t whole = layout.packets(unsigned(frame.settings.width), unsigned(frame.settings.height));
            kernel_.set("counters", counters_.fit(device_->context(), std::max<size_t>(whole, counted_) * sizeof(cl_uint4)));
            kernel_.set("distances", frame.distances);
        } else if (frame.prepared.settings.debug) {
            if (frame.begin == 0) overflows_.clear(frame.queue);
            overflows_.bind(kernel_);
        }
        frame.buffers.bind(*frame.prepared.on_device, kernel_);
        return launcher.run(*device_, frame.queue, kernel_, frame.groups, layout.local_size(), go_on, frame.begin, side_work);
    }
    cl::Event begin_count(FilmKernels& film) const override {
        return film.begin_sum(counters_.get(), counted_, FilmKernels::CounterWidth::bits32);
    }
    uint64_t overflows(Queue& queue) const override { return overflows_.read(queue); }

 private:
    KernelArguments kernel_;
    GrowingBuffer counters_{CL_MEM_READ_WRITE};
    unsigned counted_ = 0;       // packets of the last launch and of those before it in the same frame
    OverflowCounter overflows_;  // used by debug programs without counters
};

}  // namespace

RayCounts FrameTracer::end_count(FilmKernels& film, KernelTime& time, bool debug) const {
    // The order of the kernels' counters. Those of `path` are four for five numbers: cl/tracers/path/path.cl.
    using Of = uint64_t RayCounts::*;
    const bool path = program_->row.has(kSumsSamples);
    const Of third = path ? &RayCounts::not_finite : &RayCounts::dropped;
    const Of fourth = path && !debug ? &RayCounts::dropped : &RayCounts::overflowed;
    const std::array<uint64_t, 4> sums = film.end_sum(time);
    RayCounts counts;
    counts.shadow = sums[0], counts.secondary = sums[1], counts.*third = sums[2], counts.*fourth = sums[3];
    return counts;
}

#define ROW(id) const Tracer& id##_tracer();
#include "tracers/tracers.inl"
#undef ROW

Tracer tracer_with(const char* id, void (*smoke)(const Smoke& smoke)) {
    Tracer tracer;
    tracer.id = id;
    tracer.smoke = smoke;
    return tracer;
}

const std::vector<const Tracer*>& tracers() {
#define ROW(id) &id##_tracer(),
    static const std::vector<const Tracer*> all = {
#include "tracers/tracers.inl"
    };
#undef ROW
    return all;
}

const std::vector<TracerChoice>& tracer_choices() {
    static const std::vector<TracerChoice> choices = [] {
        std::vector<TracerChoice> chosen;
        for (const Tracer* tracer : tracers())
            if (tracer->is_choice) chosen.push_back(*tracer);
        return chosen;
    }();
    return choices;
}

const Tracer& find_tracer(std::string_view id) {
    for (const Tracer* tracer : tracers())
        if (id == tracer->id) return *tracer;
    throw std::out_of_range("no tracer `" + std::string(id) + "`");
}

const Tracer& tracer_of(const Settings& settings) {
    const char* of_aov = find_aov(settings.aov).tracer;
    return find_tracer(of_aov ? of_aov : settings.tracer);
}

const Tracer& automatic_tracer(const DeviceInfo& device, const Scene& scene) {
    const Tracer* chosen = nullptr;
    unsigned greatest = 0;
    for (const Tracer* tracer : tracers())
        if (const unsigned merit = tracer->merit ? tracer->merit(device, scene) : 0; merit > greatest)
            chosen = tracer, greatest = merit;
    if (!chosen) throw std::logic_error("no tracer suits the device");
    return *chosen;
}

std::unique_ptr<FrameTracer> open_tracer(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program) {
    const Tracer& tracer = find_tracer(program->row.tracer);
    if (tracer.open) return tracer.open(std::move(device), std::move(program));
    return std::make_unique<OneKernel>(std::move(device), std::move(program));
}

}  // namespace clarity
