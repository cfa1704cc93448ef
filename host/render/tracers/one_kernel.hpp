// one_kernel.hpp -- tracers of frames whose launch is one kernel, with a work-item for each packet.
#pragma once
#include "render/tracers/tracer.hpp"

namespace clarity {

// Sets the arguments that the kernel declares, by their names: `frame`, `first_group`, `film` and the scene's; with kCountsRays
// also `counters` (shadow rays, secondary rays, dropped rays, full stacks of each packet, 32 bits each) and `distances`;
// without, RT_OVERFLOWS_PARAM.
class OneKernel : public FrameTracer {
 public:
    OneKernel(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program);
    LaunchTimes trace(Launcher& launcher, const FrameLaunch& frame, const std::function<void()>& go_on,
                      const SideWork& side_work) override;
    cl::Event begin_count(FilmKernels& film) const override;
    uint64_t overflows(Queue& queue) const override;

 private:
    KernelArguments kernel_;
    GrowingBuffer counters_{CL_MEM_READ_WRITE};
    unsigned counted_ = 0;       // packets of the last launch and of those before it in the same frame
    OverflowCounter overflows_;  // used by debug programs without counters
};

}  // namespace clarity
