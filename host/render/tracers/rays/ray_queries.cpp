#include "render/tracers/rays/ray_queries.hpp"

#include <algorithm>
#include <cstring>

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

// So few rays are traced before a launch has begun and ended: trials of other kernels, and compiling them, would cost more than
// they could save.
constexpr size_t kFewRays = 64;

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

double RayQueries::trace(const Prepared& prepared, const Given& rays, const RayQuery& query,
                         const std::function<void(const cl::Buffer&, cl_uint)>& answered) {
    tuning_ = {};
    if (rays.count == 0) return 0;
    const Layout& layout = prepared.layout;
    if (rays.lanes != layout.lanes)
        throw Error(Exit::failed, "the rays are packed for " + std::to_string(rays.lanes) + " lanes and the program has " +
                                      std::to_string(layout.lanes) + ": pack them again");
    const bool unplaced = layout.lanes == 1 && prepared.accel->scene.instances.empty();
    const cl_uint fields = query.count     ? kAnswerCounted
                           : query.any_hit ? RT_ANSWER_OCCLUSION
                           : query.brief   ? RT_ANSWER_NEAREST
                           : unplaced      ? RT_ANSWER_HIT
                                           : RT_ANSWER_ALL;
    const size_t blocks = (rays.count + layout.lanes - 1) / layout.lanes;
    const Asked asked{prepared.on_device, prepared.program, blocks, query.any_hit, query.count, query.brief};
    if (!(asked == last_)) {
        if (!last_.alike(asked)) packing_ = 0;
        last_ = asked;
        launchers_.clear();
    }
    const bool few = rays.count <= kFewRays && !query.count;
    if (!few && packing_ != rays.packing) {
        packing_ = rays.packing;
        kernels_ = kernels_for(*prepared.accel->layout, layout, votes(device_->info(), prepared.settings), query);
        autotuner_ = Autotuner(static_cast<unsigned>(kernels_.size()));
    }
    const KernelRow& row = few ? plain_rays() : *kernels_[autotuner_.variant()];
    Progress never_cancelled;
    const auto program = tried_program(programs_, prepared, row, query.progress ? *query.progress : never_cancelled);
    if (!few) tuning_ = {autotuner_.variant(), autotuner_.trying(), false};
    Queue& queue = device_->queue();
    rt_frame frame = make_frame(View(), prepared.settings, layout, *prepared.accel, 0);
    frame.ray_mask = query.mask;
    view_.write(queue, *prepared.scene, *prepared.on_device, {frame}, View());
    const cl::Buffer& out = out_.fit(device_->context(), std::max(blocks * layout.lanes, rays.room) * fields * sizeof(float));
    const cl::Buffer in = rays.upload();
    const bool debug = prepared.settings.debug;
    if (debug) overflows_.clear(queue);
    const LaunchTimes times =
        trace({prepared, *program, static_cast<unsigned>(blocks), query.any_hit, fields, in, out, query.progress});
    tuning_.processor_ms = times.processor_ms;
    overflowed_ = debug ? overflows_.read(queue) : 0;
    if (!query.quiet) report_overflows(overflowed_, prepared.accel->plugin->id);
    if (!few) {
        autotuner_.took(times.device_ms / double(blocks));  // pieces of one packing may differ in size
        tuning_.settled = autotuner_.settled();
    }
    answered(out, fields);
    return times.device_ms;
}

double RayQueries::trace(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits) {
    return wrap_cl_errors(*device_, "tracing rays", [&] {
        if (hits) hits->assign(rays.ray_count(), {});
        const auto upload = [&] {
            const size_t bytes = rays.floats().size() * sizeof(float);
            const cl::Buffer& in = in_.fit(device_->context(), bytes);
            // We upload before every run, even if the rays are unchanged. A CPU's caches are then equally warm each time.
            device_->queue().enqueueWriteBuffer(in, CL_TRUE, 0, bytes, rays.floats().data());
            return in;
        };
        const auto take = [&](size_t first, size_t count, const rt_hit* some) {
            std::memcpy(&(*hits)[first], some, count * sizeof *some);
        };
        return trace(prepared, {rays.ray_count(), 0, rays.lanes(), rays.packing(), upload}, query,
                     [&](const cl::Buffer& out, cl_uint fields) {
                         if (hits) read_answers(out, rays.ray_count(), rays.lanes(), fields, take, query.work);
                     });
    });
}

double RayQueries::trace(const Prepared& prepared, const RayArrays& rays, RayQuery query) {
    return wrap_cl_errors(*device_, "tracing rays", [&] {
        const unsigned lanes = prepared.layout.lanes;
        const auto upload = [&] {
            if (rays.packed()) return rays.packed;
            const size_t room = std::max(rays.count, rays.room);
            const cl::Buffer& in = in_.fit(device_->context(), block_floats(room, lanes) * sizeof(float));
            write_rays(in, rays.count, lanes, rays.read);
            return in;
        };
        return trace(prepared, {rays.count, rays.room, lanes, rays.packing, upload}, query,
                     [&](const cl::Buffer& out, cl_uint fields) {
                         read_answers(out, rays.count, lanes, fields, rays.take, query.work);
                     });
    });
}

cl::Buffer RayQueries::pack_on_device(size_t count, unsigned lanes, const ReadRays& read) {
    return wrap_cl_errors(*device_, "packing rays", [&] {
        const cl::Buffer in =
            GrowingBuffer(CL_MEM_READ_ONLY).fit(device_->context(), block_floats(count, lanes) * sizeof(float));
        write_rays(in, count, lanes, read);
        return in;
    });
}

// What is mapped lies in the device's memory if that is the host's.
void RayQueries::write_rays(const cl::Buffer& in, size_t count, unsigned lanes, const ReadRays& read) {
    const Queue& queue = device_->queue();
    void* const mapped =
        queue.enqueueMapBuffer(in, CL_TRUE, CL_MAP_WRITE_INVALIDATE_REGION, 0, block_floats(count, lanes) * sizeof(float));
    pack_rays(count, lanes, read, static_cast<float*>(mapped));
    queue.enqueueUnmapMemObject(in, mapped);
}

void RayQueries::read_answers(const cl::Buffer& out, size_t count, unsigned lanes, cl_uint fields, const TakeHits& take,
                              std::vector<RayWork>* work) {
    const Queue& queue = device_->queue();
    void* const mapped =
        queue.enqueueMapBuffer(out, CL_TRUE, CL_MAP_READ, 0, (count + lanes - 1) / lanes * lanes * fields * sizeof(float));
    unpack_hits(static_cast<const float*>(mapped), count, lanes, fields, take);
    if (work && fields == kAnswerCounted) *work = unpack_work(static_cast<const float*>(mapped), count, lanes);
    queue.enqueueUnmapMemObject(out, mapped);
}

std::vector<rt_hit> RayQueries::trace(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query) {
    std::vector<rt_hit> hits;
    trace(prepared, RayBlocks(rays, prepared.layout.lanes), query, &hits);
    return hits;
}

}  // namespace clarity
