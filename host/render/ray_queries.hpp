// ray_queries.hpp -- rays of the caller's own through the traversals that pictures use.
#pragma once
#include "render/launch.hpp"
#include "render/renderer.hpp"
#include "render/trace_program.hpp"
#include "render/view_buffers.hpp"

namespace clarity {

class RayQueries {
 public:
    explicit RayQueries(std::shared_ptr<Device> device) : device_(device), programs_(device) {}
    std::vector<rt_hit> trace(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query, double* device_ms);

 private:
    std::shared_ptr<Device> device_;
    ProgramCache programs_;  // counting and plain ones
    ViewBuffers view_;
    Launcher launcher_;
    std::shared_ptr<const TraceProgram> last_program_;
    std::shared_ptr<const DeviceScene> last_scene_;
    GrowingBuffer in_{CL_MEM_READ_ONLY}, out_{CL_MEM_WRITE_ONLY};
};

}  // namespace clarity
