#include "render/tracers/wavefront/wavefront.hpp"

#include <algorithm>

#include "render/kernels/program_cache.hpp"

namespace clarity {
namespace {

// Sizes as wavefront.cl defines them.
constexpr size_t kRayBytes = 48, kShareBytes = 24;
constexpr size_t kControlBytes = 17 * 2 * sizeof(cl_uint);
// Work-groups that a compute unit of a GPU runs or keeps ready: 32 warps of 32.
constexpr unsigned kGroupsPerUnit = 16;
// Queues may take 1 / kQueueShare of a device's memory. On a CPU they should stay in its caches.
constexpr unsigned kQueueShare = 8;
constexpr uint64_t kCpuBytes = 64 << 20;
constexpr uint64_t kMostCounted = 1u << 30;  // a uint counts them, including those that find no room

// Sets a kernel's arguments one after the other.
class Arguments {
 public:
    explicit Arguments(cl::Kernel& kernel) : kernel_(kernel) {}
    template <class T>
    Arguments& operator<<(const T& value) {
        kernel_.setArg(at_++, value);
        return *this;
    }
    cl_uint count() const { return at_; }

 private:
    cl::Kernel& kernel_;
    cl_uint at_ = 0;
};

}  // namespace

bool refracts(const Scene& scene, const std::vector<rt_material>& materials) {
    const auto clear = [](const rt_material& material) { return material.refract > 0; };
    if (!materials.empty()) return std::any_of(materials.begin(), materials.end(), clear);
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [&](const Material& material) { return clear(material.values); });
}

// A level's queue holds `ray_slots` rays per pixel on average. A picture is traced in pieces so small that their rays fit.
Wavefront::Room Wavefront::room_for(const WavefrontFrame& frame) const {
    const Layout& layout = frame.layout;
    if (!refracts(*frame.prepared.scene, frame.view.materials)) return {0, frame.groups, false};
    const uint64_t group_rays = uint64_t(layout.group_packets()) * layout.packet_w * layout.packet_h *
                                static_cast<unsigned>(frame.prepared.settings.ray_slots);
    const DeviceInfo& info = device_->info();
    uint64_t most = (info.cpu ? kCpuBytes : info.global_bytes / kQueueShare) / (2 * kRayBytes);
    if (info.max_allocation_bytes) most = std::min(most, info.max_allocation_bytes / kRayBytes);
    most = std::min(most, kMostCounted);
    const auto fitting = static_cast<unsigned>(std::clamp<uint64_t>(most / group_rays, 1, frame.groups));
    return {static_cast<unsigned>(fitting * group_rays), fitting, true};
}

void Wavefront::bind(const WavefrontFrame& frame, const Room& room) {
    const cl::Context& context = device_->context();
    const size_t pixels = size_t(frame.width) * frame.height;
    if (program_ != frame.prepared.program) {
        trace_ = frame.prepared.program->kernel();
        add_ = cl::Kernel(frame.prepared.program->program, "add_sample");
        program_ = frame.prepared.program;
    }
    for (cl::Buffer& control : control_)
        if (!control()) control = cl::Buffer(context, CL_MEM_READ_WRITE, kControlBytes);
    work_groups_ = std::max(1u, device_->info().compute_units) * kGroupsPerUnit;
    counters_.fit(context, size_t(work_groups_) * sizeof(cl_ulong4));
    for (GrowingBuffer& rays : rays_) rays.fit(context, room.rays * kRayBytes);
    shares_.fit(context, room.splits ? pixels * kShareBytes : 0);
    sums_.fit(context, room.splits && frame.sample > 0 ? pixels * sizeof(cl_float4) : 0);
}

Launcher::Piece Wavefront::enqueue(cl::CommandQueue& queue, const WavefrontFrame& frame, const Room& room, unsigned first,
                                   unsigned count) {
    const size_t local = frame.layout.local_size(), global = work_groups_ * local;
    const cl::Buffer& sums = room.splits && frame.sample > 0 ? sums_.get() : frame.film;
    first += frame.begin;
    Launcher::Piece piece;
    const auto enqueue_levels = [&](cl_uint parity) {
        const unsigned levels = room.splits ? frame.depth : 1;
        for (cl_uint level = 0; level < levels; ++level) {
            Arguments arguments(trace_);
            arguments << frame.view_buffers.frame() << cl_uint(first) << cl_uint(count) << level
                      << cl_uint(first == 0 && level == 0) << cl_uint(room.rays) << cl_uint(room.splits) << sums
                      << shares_.get() << counters_.get() << frame.distances << rays_[level & 1].get()
                      << rays_[~level & 1].get() << control_[parity] << control_[parity ^ 1];
            frame.view_buffers.bind(*frame.prepared.on_device, trace_, arguments.count());
            queue.enqueueNDRangeKernel(trace_, cl::NullRange, cl::NDRange(global), cl::NDRange(local), nullptr, &piece.last);
            if (level == 0) piece.first = piece.last;
        }
        if (!room.splits) return;
        Arguments(add_) << frame.view_buffers.frame() << cl_uint(first) << frame.film << sums << shares_.get();
        queue.enqueueNDRangeKernel(add_, cl::NullRange, cl::NDRange(count * local), cl::NDRange(local), nullptr, &piece.last);
    };
    ping_pong_.take([&](cl_uint parity) { queue.enqueueFillBuffer(control_[parity], cl_uint(0), 0, kControlBytes); },
                    enqueue_levels);
    return piece;
}

LaunchTimes Wavefront::trace(cl::CommandQueue& queue, Launcher& launcher, const WavefrontFrame& frame,
                             const std::function<void()>& go_on, const SideWork& side_work) {
    const Room room = room_for(frame);
    bind(frame, room);
    const auto piece = [&](unsigned first, unsigned count) { return enqueue(queue, frame, room, first, count); };
    return launcher.run(*device_, queue, frame.groups, room.groups, piece, go_on, side_work);
}

}  // namespace clarity
