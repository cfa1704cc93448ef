#include "render/queries/ray_queries.hpp"

#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "render/frame/frame_constants.hpp"
#include "render/trial/trial.hpp"

namespace clarity {
namespace {

// Whether to use the kernels that trace the rays of a warp together (cl/lanes/subgroup.h). With `portable` each work-item runs
// them alone, so that tests without a GPU cover these kernels too.
bool votes(const DeviceInfo& info, const Settings& settings) {
    return (info.nvidia && !info.pocl) || settings.portable;
}

// Kernels that answer a query, the plain one first. The others need capabilities of the structure.
std::vector<KernelKind> kinds_for(const rt_plugin& accel, const Layout& layout, bool votes, RayQuery query) {
    if (query.count) return {KernelKind::counted_rays};
    std::vector<KernelKind> kinds{KernelKind::rays};
    if (layout.lanes > 1 || layout.cpu) return kinds;
    for (const KernelRow& row : kernel_table())
        if (row.needs != 0 && (row.needs & ~accel.accel->capabilities) == 0 && (votes || !row.has(kVotes)) &&
            (!query.any_hit || !row.has(kNearestOnly)) && kinds.size() < Autotuner::kMost)
            kinds.push_back(row.kind);
    return kinds;
}

}  // namespace

LaunchTimes RayQueries::trace_at_once(const Prepared& prepared, const TraceProgram& program, const Layout& layout,
                                      size_t blocks, bool any_hit, cl_uint fields, const cl::Buffer& in,
                                      const cl::Buffer& out) {
    cl::Kernel kernel = program.kernel();
    cl_uint at = 0;
    kernel.setArg(at++, view_.frame());
    const cl_uint first_group = at++;
    kernel.setArg(at++, static_cast<cl_uint>(blocks));
    kernel.setArg(at++, static_cast<cl_uint>(any_hit));
    kernel.setArg(at++, fields);
    kernel.setArg(at++, in);
    kernel.setArg(at++, out);
    view_.bind(*prepared.on_device, kernel, overflows_.bind(kernel, at, prepared.settings.debug));
    const unsigned each = program.row.rays_per_item;
    const size_t in_group = each ? layout.local_size() * each : size_t(layout.group_packets()) * layout.blocks();
    const size_t groups = (blocks + in_group - 1) / in_group;
    return launchers_[program.row.kind].run(*device_, device_->queue(), kernel, first_group, static_cast<unsigned>(groups),
                                            layout.local_size(), [] {});
}

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
            requeued_rays_.forget();
            dynamic_fetch_.forget();
        }
        if (packing_ != rays.packing()) {
            packing_ = rays.packing();
            kinds_ = kinds_for(*prepared.accel->layout, layout, votes(device_->info(), prepared.settings), query);
            autotuner_ = Autotuner(static_cast<unsigned>(kinds_.size()));
        }
        const KernelKind kind = kinds_[autotuner_.variant()];
        Progress never_cancelled;
        const auto program = tried_program(programs_, prepared, kind, never_cancelled);
        tuning_ = {autotuner_.variant(), autotuner_.trying(), false};
        cl::CommandQueue& queue = device_->queue();
        view_.write(queue, *prepared.scene, *prepared.on_device,
                    {make_frame(View(), prepared.settings, layout, *prepared.accel, 0)}, View());
        const cl::Buffer& in = in_.fit(device_->context(), rays.floats().size() * sizeof(float));
        const cl::Buffer& out = out_.fit(device_->context(), slots * fields * sizeof(float));
        // We upload before every run, even if the rays are unchanged. A CPU's caches are then equally warm each time.
        queue.enqueueWriteBuffer(in, CL_TRUE, 0, rays.floats().size() * sizeof(float), rays.floats().data());
        const bool debug = prepared.settings.debug;
        if (debug) overflows_.clear(queue);
        const LaunchTimes times =
            kind == KernelKind::requeued_rays ? requeued_rays_.trace(prepared, *program, view_, static_cast<unsigned>(slots),
                                                                     query.any_hit, fields, in, out, overflows_)
            : kind == KernelKind::dynamic_fetch
                ? dynamic_fetch_.trace(prepared, *program, view_, static_cast<unsigned>(slots), fields, in, out, overflows_)
                : trace_at_once(prepared, *program, layout, rays.block_count(), query.any_hit, fields, in, out);
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

}  // namespace clarity
