#include "render/tracers/one_kernel.hpp"

namespace clarity {

OneKernel::OneKernel(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program)
    : FrameTracer(std::move(device), std::move(program)), kernel_(program_->kernel()) {}

LaunchTimes OneKernel::trace(Launcher& launcher, const FrameLaunch& frame, const std::function<void()>& go_on,
                             const SideWork& side_work) {
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

cl::Event OneKernel::begin_count(FilmKernels& film) const {
    return film.begin_sum(counters_.get(), counted_, FilmKernels::CounterWidth::bits32);
}

uint64_t OneKernel::overflows(Queue& queue) const {
    return overflows_.read(queue);
}

}  // namespace clarity
