// wavefront.cpp -- the tracer `wavefront`: ray queues on the device, and the order of its kernels (cl/tracers/wavefront).
#include <algorithm>

#include "launch/ping_pong.hpp"
#include "tracers/tracer.hpp"

namespace clarity {
namespace {

constexpr size_t kRayBytes = 48;  // as in wavefront.cl
constexpr size_t kShareBytes = RT_SHARE * sizeof(cl_uint), kControlBytes = RT_CONTROLS * sizeof(cl_uint);
// Work-groups that a compute unit of a GPU runs or keeps ready: 32 warps of 32.
constexpr unsigned kGroupsPerUnit = 16;
// Queues may take 1 / kQueueShare of a device's memory. On a CPU they should stay in its caches.
constexpr unsigned kQueueShare = 8;
constexpr uint64_t kCpuBytes = 64 << 20;
constexpr uint64_t kMostCounted = 1u << 30;  // a uint counts them, including those that find no room

// Whether a ray may split in two: one sees through some surface. materials: those of the view; none: those of the scene.
bool refracts(const Scene& scene, const std::vector<MaterialValues>& materials) {
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const rt_material& m = materials.empty() ? scene.materials[i].values : materials[i];
        if (scene.materials[i].used && (m.refract > 0 || m.alpha == RT_ALPHA_BLEND)) return true;
    }
    return false;
}

class Wavefront : public FrameTracer {
 public:
    Wavefront(std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program)
        : FrameTracer(std::move(device), std::move(program)),
          trace_(program_->kernel()),
          add_(program_->kernel("add_sample")),
          work_groups_(std::max(1u, device_->info().compute_units) * kGroupsPerUnit) {}

    LaunchTimes trace(Launcher& launcher, const FrameLaunch& frame, const std::function<void()>& go_on,
                      const SideWork& side_work) override {
        const Room room = room_for(frame);
        make_buffers(frame, room);
        const auto piece = [&](unsigned first, unsigned count) { return enqueue(frame, room, first, count); };
        return launcher.run(*device_, frame.queue, frame.groups, room.groups, piece, go_on, side_work);
    }
    bool takes_layers(const Prepared& prepared, const View& view) const override {
        return !refracts(*prepared.scene, view.materials);
    }
    // Of each work-group: shadow rays, secondary rays, dropped rays, full stacks, 64 bits each.
    cl::Event begin_count(FilmKernels& film) const override {
        return film.begin_sum(counters_.get(), work_groups_, FilmKernels::CounterWidth::bits64);
    }
    uint64_t overflows(Queue&) const override { return 0; }

 private:
    // How many rays a level's queue holds, and for how many groups of pixels that is meant.
    struct Room {
        unsigned rays, groups;
        bool splits;  // rays may split
    };
    Room room_for(const FrameLaunch& frame) const;
    void make_buffers(const FrameLaunch& frame, const Room& room);
    Launcher::Piece enqueue(const FrameLaunch& frame, const Room& room, unsigned first, unsigned count);

    KernelArguments trace_, add_;
    GrowingBuffer rays_[2] = {GrowingBuffer(CL_MEM_READ_WRITE), GrowingBuffer(CL_MEM_READ_WRITE)};
    GrowingBuffer sums_{CL_MEM_READ_WRITE}, shares_{CL_MEM_READ_WRITE}, counters_{CL_MEM_READ_WRITE};
    cl::Buffer control_[2];  // a picture's first kernel clears the other one for the next picture
    PingPong ping_pong_;     // of control_
    const unsigned work_groups_;
};

// A level's queue holds `ray_slots` rays per pixel on average. A picture is traced in pieces so small that their rays fit.
Wavefront::Room Wavefront::room_for(const FrameLaunch& frame) const {
    const Layout& layout = frame.prepared.layout;
    if (takes_layers(frame.prepared, frame.view)) return {0, frame.groups, false};
    const uint64_t group_rays = uint64_t(layout.group_packets()) * layout.packet_w * layout.packet_h *
                                static_cast<unsigned>(frame.prepared.settings.ray_slots);
    const DeviceInfo& info = device_->info();
    uint64_t most = (info.cpu ? kCpuBytes : info.global_bytes / kQueueShare) / (2 * kRayBytes);
    if (info.max_allocation_bytes) most = std::min(most, info.max_allocation_bytes / kRayBytes);
    most = std::min(most, kMostCounted);
    const auto fitting = static_cast<unsigned>(std::clamp<uint64_t>(most / group_rays, 1, frame.groups));
    return {static_cast<unsigned>(fitting * group_rays), fitting, true};
}

void Wavefront::make_buffers(const FrameLaunch& frame, const Room& room) {
    const cl::Context& context = device_->context();
    const size_t pixels = size_t(frame.settings.width) * size_t(frame.settings.height);
    for (cl::Buffer& control : control_)
        if (!control()) control = cl::Buffer(context, CL_MEM_READ_WRITE, kControlBytes);
    counters_.fit(context, size_t(work_groups_) * sizeof(cl_ulong4));
    for (GrowingBuffer& rays : rays_) rays.fit(context, room.rays * kRayBytes);
    shares_.fit(context, room.splits ? pixels * kShareBytes : 0);
    sums_.fit(context, room.splits && frame.sample > 0 ? pixels * sizeof(cl_float4) : 0);
}

Launcher::Piece Wavefront::enqueue(const FrameLaunch& frame, const Room& room, unsigned first, unsigned count) {
    Queue& queue = frame.queue;
    const size_t local = frame.prepared.layout.local_size(), global = work_groups_ * local;
    const cl::Buffer& sums = room.splits && frame.sample > 0 ? sums_.get() : frame.film;
    first += frame.begin;
    Launcher::Piece piece;
    const auto enqueue_levels = [&](cl_uint parity) {
        const unsigned levels = room.splits ? static_cast<unsigned>(frame.settings.depth) : 1;
        frame.buffers.bind(*frame.prepared.on_device, trace_);
        trace_.set("first_group", cl_uint(first)).set("group_count", cl_uint(count));
        trace_.set("room", cl_uint(room.rays)).set("parting", cl_uint(room.splits));
        trace_.set("sums", sums).set("shares", shares_.get()).set("counters", counters_.get());
        trace_.set("distances", frame.distances);
        trace_.set("control", control_[parity]).set("idle_control", control_[parity ^ 1]);
        for (cl_uint level = 0; level < levels; ++level) {
            trace_.set("level", level).set("fresh", cl_uint(first == 0 && level == 0));
            trace_.set("rays", rays_[level & 1].get()).set("next", rays_[~level & 1].get());
            queue.enqueueNDRangeKernel(trace_.kernel(), cl::NullRange, cl::NDRange(global), cl::NDRange(local), nullptr,
                                       &piece.last);
            if (level == 0) piece.first = piece.last;
        }
        if (!room.splits) return;
        add_.set("frame", frame.buffers.frame()).set("first_group", cl_uint(first)).set("film", frame.film);
        add_.set("sums", sums).set("shares", shares_.get());
        queue.enqueueNDRangeKernel(add_.kernel(), cl::NullRange, cl::NDRange(count * local), cl::NDRange(local), nullptr,
                                   &piece.last);
    };
    ping_pong_.take([&](cl_uint parity) { queue.enqueueFillBuffer(control_[parity], cl_uint(0), 0, kControlBytes); },
                    enqueue_levels);
    return piece;
}

const KernelRow& kernel(const Settings&, const Layout&) {
    static const KernelRow row = [] {
        KernelRow r;
        r.tracer = "wavefront";
        r.what = "tracer wavefront";
        r.file = "tracers/wavefront/wavefront.cl";
        r.entry = "trace_wavefront";
        r.headers = material_headers();
        r.headers.insert(r.headers.end(), {"shading/shading.h", "tracers/ray_step.h", "lanes/work_distribution.h",
                                           "tracers/wavefront/wavefront_rays.h"});
        r.traits = kLimitRegisters | kFrame | kCountsRays | kWhitted;
        return r;
    }();
    return row;
}

}  // namespace

// Without refraction no ray splits. `wavefront` is then a single launch, and its warps fetch new pixels as soon as they are
// free. That is 1.03 to 1.10 times as fast on a GPU. With refraction the faster tracer depends on the scene: see
// docs/experiments.md.
const Tracer& wavefront_tracer() {
    static const Tracer tracer = [] {
        Tracer t;
        t.id = "wavefront";
        t.help = "rays that split continue in queues in the device's memory";
        t.when = "on a GPU if nothing refracts";
        t.picture = kWhittedPicture;
        t.kernel = kernel;
        t.is_choice = true;
        t.merit = [](const DeviceInfo& info, const Scene& scene) {
            return !info.traces_packets() && !refracts(scene, {}) ? 2u : 0u;
        };
        t.open = [](std::shared_ptr<Device> device, std::shared_ptr<const TraceProgram> program) {
            return std::unique_ptr<FrameTracer>(std::make_unique<Wavefront>(std::move(device), std::move(program)));
        };
        return t;
    }();
    return tracer;
}

}  // namespace clarity
