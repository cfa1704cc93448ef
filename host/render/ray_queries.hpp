// ray_queries.hpp -- rays of the caller's own through the traversals that pictures use.
#pragma once
#include "render/launch.hpp"
#include "render/ray_blocks.hpp"
#include "render/renderer.hpp"
#include "render/trace_program.hpp"
#include "render/view_buffers.hpp"

namespace clarity {

class RayQueries {
 public:
    explicit RayQueries(std::shared_ptr<Device> device) : device_(device), programs_(device) {}
    // Returns what the kernel took, ms by the device's clock. hits: null: the answers stay on the device. Throws Error(failed)
    // if the rays were packed for other lanes.
    double trace(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits);

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
