#include "tracers/rays/ray_queries.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "device/kernel_files.hpp"
#include "launch/frame_constants.hpp"
#include "tracers/rays/ray_kernels.hpp"
#include "trial/trial.hpp"

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

cl_uint RayQueries::answer_fields(const Prepared& prepared, const RayQuery& query) {
    return query.count                               ? kAnswerCounted
           : query.any_hit                           ? RT_ANSWER_OCCLUSION
           : query.brief                             ? RT_ANSWER_NEAREST
           : prepared.accel->scene.instances.empty() ? RT_ANSWER_HIT
                                                     : RT_ANSWER_PLACED;
}

TraceProgram& RayQueries::program_of(const Prepared& prepared, uint64_t number, const KernelRow& row, Progress& progress) {
    const uint64_t revision = kernel_text_revision();
    if (number == 0 || number != looked_up_.prepared || revision != looked_up_.text_revision)
        looked_up_ = {number, revision, {}, {}, {}};
    std::shared_ptr<TraceProgram>& program = looked_up_.programs[&row];
    if (!program) program = tried_program(programs_, prepared, row, progress);
    return *program;
}

RayQueries::Choice& RayQueries::choice_for(const Prepared& prepared, uint64_t packing, size_t blocks, const RayQuery& query) {
    if (prepared.on_device != scene_ || prepared.program != program_) {
        choices_.clear();
        scene_ = prepared.on_device;
        program_ = prepared.program;
    }
    const auto found =
        std::find_if(choices_.begin(), choices_.end(), [&](const Choice& choice) { return choice.is(packing, query); });
    if (found != choices_.end()) {
        choices_.splice(choices_.begin(), choices_, found);
    } else {
        if (choices_.size() == kMostChoices) choices_.pop_back();
        std::vector<const KernelRow*> kernels{&plain_rays()};
        if (packing != kFew)
            kernels = kernels_for(*prepared.accel->layout, prepared.layout, votes(device_->info(), prepared.settings), query);
        const auto variants = static_cast<unsigned>(kernels.size());
        choices_.push_front(
            {packing, query.any_hit, query.count, query.brief, std::move(kernels), Autotuner(variants), blocks, {}});
    }
    Choice& choice = choices_.front();
    if (choice.blocks != blocks) choice.launchers.clear();
    choice.blocks = blocks;
    return choice;
}

void RayQueries::write_frame(const Prepared& prepared, rt_u32 mask) {
    looked_up_.mask.reset();
    rt_frame frame = make_frame(View(), prepared.settings, prepared.layout, *prepared.accel, 0);
    frame.ray_mask = mask;
    view_.write(device_->queue(), *prepared.scene, *prepared.on_device, {frame}, View());
}

double RayQueries::trace(const Prepared& prepared, const Given& rays, const RayQuery& query, Answers& answers) {
    tuning_ = {};
    answers.count = rays.count;
    answers.fields = answer_fields(prepared, query);
    if (rays.count == 0) return 0;
    const Layout& layout = prepared.layout;
    if (rays.lanes != layout.lanes)
        throw Error(Exit::failed, "the rays are packed for " + std::to_string(rays.lanes) + " lanes and the program has " +
                                      std::to_string(layout.lanes) + ": pack them again");
    const size_t blocks = (rays.count + layout.lanes - 1) / layout.lanes;
    const bool few = rays.count <= kFewRays && !query.count;
    Choice& choice = choice_for(prepared, few ? kFew : rays.packing, blocks, query);
    Autotuner& autotuner = choice.autotuner;
    const KernelRow& row = *choice.kernels[autotuner.variant()];
    Progress never_cancelled;
    const TraceProgram& program = program_of(prepared, rays.prepared, row, query.progress ? *query.progress : never_cancelled);
    if (!few) tuning_ = {autotuner.variant(), autotuner.trying(), false};
    Queue& queue = device_->queue();
    if (looked_up_.mask != query.mask) write_frame(prepared, query.mask);
    looked_up_.mask = query.mask;
    if (!answers.buffer()) {
        answers.stride = answer_stride(rays.count);
        answers.buffer =
            out_.fit(device_->context(), std::max(answers.stride, answer_stride(rays.room)) * answers.fields * sizeof(float));
    }
    const cl::Buffer in = rays.upload();
    const bool debug = prepared.settings.debug;
    if (debug) overflows_.clear(queue);
    SideWork side_work;
    if (rays.answers_are_read) side_work.behind = [&] { return copies_->read_ahead(answers.buffer, answers.bytes()); };
    const LaunchTimes times = trace({prepared, program, static_cast<unsigned>(blocks), query.any_hit, in, answers,
                                     query.progress, choice.launchers[&row], std::move(side_work)});
    tuning_.processor_ms = times.processor_ms;
    overflowed_ = debug ? overflows_.read(queue) : 0;
    if (!query.quiet) report_overflows(overflowed_, prepared.accel->plugin->id);
    if (!few) {
        autotuner.took(times.device_ms / double(blocks));  // pieces of one packing may differ in size
        tuning_.settled = autotuner.settled();
    }
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
        Answers answers;
        const double ms =
            trace(prepared, {rays.ray_count(), 0, rays.lanes(), rays.packing(), 0, false, upload}, query, answers);
        if (!hits || hits->empty()) return ms;
        const Queue& queue = device_->queue();
        void* const mapped = queue.enqueueMapBuffer(answers.buffer, CL_TRUE, CL_MAP_READ, 0, answers.bytes());
        const auto* numbers = static_cast<const float*>(mapped);
        unpack_hits(
            numbers, answers.count, answers.stride, answers.fields,
            [&](size_t first, size_t count, const rt_hit* some) { std::memcpy(&(*hits)[first], some, count * sizeof *some); });
        if (query.work && query.count) *query.work = unpack_work(numbers, answers.count, answers.stride);
        queue.enqueueUnmapMemObject(answers.buffer, mapped);
        return ms;
    });
}

double RayQueries::trace(const Prepared& prepared, const RayArrays& rays, RayQuery query, Answers& answers) {
    return wrap_cl_errors(*device_, "tracing rays", [&] {
        const unsigned lanes = prepared.layout.lanes;
        answers = rays.all ? *rays.all : Answers();
        answers.before = rays.all ? rays.first : 0;
        const auto upload = [&] {
            if (rays.packed()) return rays.packed;
            const size_t room = std::max(rays.count, rays.room);
            const cl::Buffer& in = in_.fit(device_->context(), block_floats(room, lanes) * sizeof(float));
            write_rays(in, rays.count, lanes, rays.read);
            return in;
        };
        return trace(prepared, {rays.count, rays.room, lanes, rays.packing, rays.prepared, !rays.all, upload}, query, answers);
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

void RayQueries::write_rays(const cl::Buffer& in, size_t count, unsigned lanes, const ReadRays& read) {
    constexpr size_t kRayBytes = RT_RAY_FIELDS * sizeof(float);
    copies_->write(in, block_floats(count, lanes) * sizeof(float), [&](void* piece, size_t before, size_t bytes) {
        const size_t begin = before / kRayBytes, some = std::min(bytes / kRayBytes, count - begin);
        pack_rays(
            some, lanes, [&](size_t first, size_t n, rt_ray* to) { read(begin + first, n, to); }, static_cast<float*>(piece));
    });
}

std::vector<rt_hit> RayQueries::trace(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query) {
    std::vector<rt_hit> hits;
    trace(prepared, RayBlocks(rays, prepared.layout.lanes), query, &hits);
    return hits;
}

}  // namespace clarity
