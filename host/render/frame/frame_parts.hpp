// frame_parts.hpp -- programs that do less of a frame, or some of it twice: what the difference takes is what that part takes.
#pragma once
#include "device/device.hpp"
#include "render/kernels/program_cache.hpp"
#include "render/launch/prepared.hpp"

namespace clarity {

class FrameParts {
 public:
    explicit FrameParts(std::shared_ptr<Device> device) : programs_(device) {}
    // The same scene and structure with another program. Throws Error(kernel_build_failed).
    std::shared_ptr<const Prepared> prepare(const Prepared& whole, FramePart part);

 private:
    ProgramCache programs_;
};

}  // namespace clarity
