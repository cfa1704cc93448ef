// ray_queries.hpp -- rays of the caller's own through the traversals that pictures use.
#pragma once
#include <map>
#include <tuple>

#include "render/film/overflow_counter.hpp"
#include "render/frame/launch.hpp"
#include "render/frame/renderer.hpp"
#include "render/frame/view_buffers.hpp"
#include "render/kernels/kernel_source.hpp"
#include "render/kernels/program_cache.hpp"
#include "render/queries/autotuner.hpp"
#include "render/queries/dynamic_fetch.hpp"
#include "render/queries/ray_blocks.hpp"
#include "render/queries/requeued_rays.hpp"

namespace clarity {

class RayQueries {
 public:
    explicit RayQueries(std::shared_ptr<Device> device)
        : device_(device), programs_(device), requeued_rays_(device), dynamic_fetch_(device) {}
    // Returns what the kernel took, ms by the device's clock. hits: null: the answers stay on the device. Throws Error(failed)
    // if the rays were packed for other lanes. A debug program whose traversal stacks were full is an error in the log.
    double trace(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits);
    // How the last trace() was done.
    RayTuning tuning() const { return tuning_; }

 private:
    LaunchTimes trace_at_once(const Prepared& prepared, const TraceProgram& program, const Layout& layout, size_t blocks,
                              bool any_hit, cl_uint fields, const cl::Buffer& in, const cl::Buffer& out);

    std::shared_ptr<Device> device_;
    ProgramCache programs_;  // counting and plain ones
    ViewBuffers view_;
    std::map<KernelKind, Launcher> launchers_;  // of ways that are one launch
    RequeuedRays requeued_rays_;
    DynamicFetch dynamic_fetch_;
    // A pace is that of one program on one scene, with which what is short is one launch.
    struct Asked {
        std::shared_ptr<const DeviceScene> scene;
        std::shared_ptr<const TraceProgram> program;  // of pictures: it goes with the settings
        size_t blocks = 0;
        bool any_hit = false, count = false, brief = false;
        bool operator==(const Asked& o) const {
            return std::tie(scene, program, blocks, any_hit, count, brief) ==
                   std::tie(o.scene, o.program, o.blocks, o.any_hit, o.count, o.brief);
        }
    };
    Asked last_;
    // The fastest way is that of the same rays: mirrored ones may want another than diffuse ones.
    uint64_t packing_ = 0;
    std::vector<KernelKind> kinds_;
    Autotuner way_;
    RayTuning tuning_;
    OverflowCounter overflows_;  // of debug programs
    GrowingBuffer in_{CL_MEM_READ_ONLY}, out_{CL_MEM_READ_WRITE};
};

}  // namespace clarity
