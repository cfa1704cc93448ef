#include "render/tracers/rays/ray_queries.hpp"

#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "render/launch/frame_constants.hpp"
#include "render/tracers/rays/ray_kernels.hpp"
#include "render/trial/trial.hpp"

namespace clarity {
namespace {

// Whether to use the kernels that trace the rays of a warp together (cl/lanes/subgroup.h). With `portable` each work-item runs
// them alone, so that tests without a GPU cover these kernels too.
bool votes(const DeviceInfo& info, const Settings& settings) {
    return (info.nvidia && !info.pocl) || settings.portable;
}

// Kernels that answer a query, the plain one first. The others need capabilities of the structure.
std::vector<const KernelRow*> kernels_for(const rt_plugin& accel, const Layout& layout, bool votes, RayQuery query) {
    if (query.count) return {&counted_rays()};
    std::vector<const KernelRow*> kernels{&plain_rays()};
    if (layout.lanes > 1 || layout.cpu) return kernels;
    for (const KernelRow* row : ray_kernels_of_structures())
        if ((row->needs & ~accel.accel->capabilities) == 0 && (votes || !row->has(kVotes)) &&
            (!query.any_hit || !row->has(kNearestOnly)) && kernels.size() < Autotuner::kMost)
            kernels.push_back(row);
    return kernels;
}

}  // namespace

double RayQueries::trace(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits) {
    return wrap_cl_errors(*device_, "tracing rays", [&] {
        if (hits) hits->clear();
        tuning_ = {};
        if (rays.ray_count() == 0) return 0.0;
        const Layout& layout = prepared.layout;
        if (rays.lanes() != layout.lanes)
            throw Error(Exit::failed, "the rays are packed for " + std::to_string(rays.lanes()) +
                                          " lanes and the program has " + std::to_string(layout.lanes) + ": pack them again");
        const bool unplaced = layout.lanes == 1 && prepared.accel->scene.instances.empty();
        const cl_uint fields = query.count     ? RT_ANSWER_ALL
                               : query.any_hit ? RT_ANSWER_OCCLUSION
                               : query.brief   ? RT_ANSWER_NEAREST
                               : unplaced      ? RT_ANSWER_HIT
                                               : RT_ANSWER_ALL;
        const size_t slots = rays.block_count() * layout.lanes;
        const Asked asked{prepared.on_device, prepared.program, rays.block_count(), query.any_hit, query.count, query.brief};
        if (!(asked == last_)) {
            last_ = asked;
            packing_ = 0;
            launchers_.clear();
        }
        if (packing_ != rays.packing()) {
            packing_ = rays.packing();
            kernels_ = kernels_for(*prepared.accel->layout, layout, votes(device_->info(), prepared.settings), query);
            autotuner_ = Autotuner(static_cast<unsigned>(kernels_.size()));
        }
        const KernelRow& row = *kernels_[autotuner_.variant()];
        Progress never_cancelled;
        const auto program = tried_program(programs_, prepared, row, query.progress ? *query.progress : never_cancelled);
        tuning_ = {autotuner_.variant(), autotuner_.trying(), false};
        Queue& queue = device_->queue();
        rt_frame frame = make_frame(View(), prepared.settings, layout, *prepared.accel, 0);
        frame.ray_mask = query.mask;
        view_.write(queue, *prepared.scene, *prepared.on_device, {frame}, View());
        const cl::Buffer& in = in_.fit(device_->context(), rays.floats().size() * sizeof(float));
        const cl::Buffer& out = out_.fit(device_->context(), slots * fields * sizeof(float));
        // We upload before every run, even if the rays are unchanged. A CPU's caches are then equally warm each time.
        queue.enqueueWriteBuffer(in, CL_TRUE, 0, rays.floats().size() * sizeof(float), rays.floats().data());
        const bool debug = prepared.settings.debug;
        if (debug) overflows_.clear(queue);
        const LaunchTimes times =
            trace({prepared, *program, static_cast<unsigned>(rays.block_count()), query.any_hit, fields, in, out});
        overflowed_ = debug ? overflows_.read(queue) : 0;
        if (!query.quiet) report_overflows(overflowed_, prepared.accel->plugin->id);
        autotuner_.took(times.device_ms);
        tuning_.settled = autotuner_.settled();
        if (hits) {
            std::vector<float> answers(slots * fields);
            queue.enqueueReadBuffer(out, CL_TRUE, 0, answers.size() * sizeof(float), answers.data());
            *hits = unpack_hits(answers, rays.ray_count(), layout.lanes, fields, query.count);
        }
        return times.device_ms;
    });
}

std::vector<rt_hit> RayQueries::trace(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query) {
    std::vector<rt_hit> hits;
    trace(prepared, RayBlocks(rays, prepared.layout.lanes), query, &hits);
    return hits;
}

}  // namespace clarity
