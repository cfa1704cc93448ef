#include "render/wavefront.hpp"

#include <algorithm>

#include "render/trace_program.hpp"

namespace clarity {
namespace {

// As wavefront.cl has them.
constexpr size_t kRayBytes = 48, kOrderBytes = 4, kLightBytes = 16, kClaimBytes = 8;
constexpr size_t kControlBytes = 17 * 2 * sizeof(cl_uint);
// Work-groups that run side by side on a compute unit, or are ready to: 32 warps of 32 on a GPU.
constexpr unsigned kGroupsPerUnit = 16;
// Of a device's memory, what queues may take; on a CPU they should stay in its caches.
constexpr unsigned kShareOfMemory = 8;
constexpr uint64_t kCpuBytes = 64 << 20;

bool refracts(const Prepared& prepared, const View& view) {
    const auto clear = [](const rt_material& material) { return material.refract > 0; };
    if (!view.materials.empty()) return std::any_of(view.materials.begin(), view.materials.end(), clear);
    const std::vector<Material>& own = prepared.scene->materials;
    return std::any_of(own.begin(), own.end(), [&](const Material& material) { return clear(material.values); });
}

// Arguments one after the other.
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

// A pixel that does not branch has one ray in each generation. One that does may have as many as `ray_slots` says, in the mean of
// all: then pieces of the picture are so small that there is room.
Wavefront::Room Wavefront::room_for(const WavefrontFrame& frame) const {
    const Layout& layout = frame.layout;
    const uint64_t groups = uint64_t(layout.groups_x(frame.width)) * layout.groups_y(frame.height);
    const uint64_t group_pixels = uint64_t(layout.group_packets()) * layout.packet_w * layout.packet_h;
    Room room{};
    room.ordered = refracts(frame.prepared, frame.view);
    const uint64_t slots = room.ordered ? uint64_t(frame.prepared.settings.ray_slots) : 1;
    const uint64_t bytes = 2 * kRayBytes + (room.ordered ? kOrderBytes + kLightBytes + kClaimBytes : 0);
    const DeviceInfo& info = device_->info();
    uint64_t most = info.cpu ? kCpuBytes : info.global_bytes / kShareOfMemory;
    if (info.max_allocation_bytes) most = std::min(most, info.max_allocation_bytes / kRayBytes * bytes);
    const uint64_t fitting = std::min<uint64_t>(most / (bytes * slots * group_pixels), (1u << 30) / (slots * group_pixels));
    room.groups = static_cast<unsigned>(std::clamp<uint64_t>(fitting, 1, groups));
    room.rays = static_cast<unsigned>(room.groups * group_pixels * slots);
    return room;
}

void Wavefront::bind(const WavefrontFrame& frame, const Room& room) {
    const cl::Context& context = device_->context();
    const TraceProgram& program = *frame.prepared.program;
    if (program_ != frame.prepared.program) {
        kernels_.trace = program.kernel();
        kernels_.order = cl::Kernel(program.program, "order_claims");
        kernels_.join = cl::Kernel(program.program, "join_rays");
        kernels_.add = cl::Kernel(program.program, "add_sample");
        program_ = frame.prepared.program;
    }
    clean_ = clean_ && control_[0]();
    for (cl::Buffer& control : control_)
        if (!control()) control = cl::Buffer(context, CL_MEM_READ_WRITE, kControlBytes);
    work_groups_ = std::max(1u, device_->info().compute_units) * kGroupsPerUnit;
    counters_.fit(context, size_t(work_groups_) * 16);
    for (GrowingBuffer& rays : rays_) rays.fit(context, room.rays * kRayBytes);
    // A chunk is a ray at least; the first generation has the camera's, those outside the picture included, in place of a queue's.
    const size_t chunks = std::max<size_t>(room.rays, size_t(room.groups) * frame.layout.group_packets() * frame.layout.rays());
    order_.fit(context, room.ordered ? room.rays * kOrderBytes : 0);
    lights_.fit(context, room.ordered ? room.rays * kLightBytes : 0);
    claims_.fit(context, room.ordered ? (chunks + 1) * kClaimBytes : 0);
    if (frame.sample > 0) sums_.fit(context, size_t(frame.width) * frame.height * sizeof(cl_float4));
}

Launcher::Piece Wavefront::enqueue(cl::CommandQueue& queue, const WavefrontFrame& frame, const Room& room, unsigned first,
                                   unsigned count) {
    const size_t local = frame.layout.local_size(), global = work_groups_ * local;
    const cl::Buffer &control = control_[turn_], &idle = control_[turn_ ^ 1],
                     &sums = frame.sample > 0 ? sums_.get() : frame.film;
    if (!clean_) queue.enqueueFillBuffer(control, cl_uint(0), 0, kControlBytes);
    clean_ = false;  // unless all goes well
    Launcher::Piece piece;
    const auto run = [&](cl::Kernel& kernel, size_t items) {
        queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(local), nullptr, &piece.last);
        if (!piece.first()) piece.first = piece.last;
    };
    for (cl_uint generation = 0; generation < frame.depth; ++generation) {
        Arguments to_trace(kernels_.trace);
        to_trace << frame.view_buffers.frame() << cl_uint(first) << cl_uint(count) << generation
                 << cl_uint(first == 0 && generation == 0) << cl_uint(room.rays) << cl_uint(room.ordered) << sums
                 << counters_.get() << frame.distances << rays_[generation & 1].get() << rays_[~generation & 1].get()
                 << order_.get() << lights_.get() << claims_.get() << control << idle;
        frame.view_buffers.bind(*frame.prepared.on_device, kernels_.trace, to_trace.count());
        run(kernels_.trace, global);
        if (!room.ordered) continue;
        if (generation + 1 < frame.depth) {
            Arguments(kernels_.order) << frame.view_buffers.frame() << cl_uint(count) << generation << cl_uint(room.rays)
                                      << control << claims_.get();
            run(kernels_.order, local);
        }
        Arguments(kernels_.join) << frame.view_buffers.frame() << cl_uint(count) << generation << cl_uint(room.rays) << sums
                                 << lights_.get() << claims_.get() << control << order_.get();
        run(kernels_.join, global);
    }
    turn_ ^= 1;
    clean_ = true;
    return piece;
}

LaunchTimes Wavefront::trace(cl::CommandQueue& queue, Launcher& launcher, const WavefrontFrame& frame,
                             const std::function<void()>& go_on) {
    const Room room = room_for(frame);
    bind(frame, room);
    const unsigned groups = frame.layout.groups_x(frame.width) * frame.layout.groups_y(frame.height);
    LaunchTimes times =
        launcher.run(queue, groups, room.groups,
                     [&](unsigned first, unsigned count) { return enqueue(queue, frame, room, first, count); }, go_on);
    if (frame.sample > 0) {
        const cl_uint pixels = frame.width * frame.height;
        const size_t local = frame.layout.local_size();
        Arguments(kernels_.add) << frame.film << sums_.get() << pixels;
        queue.enqueueNDRangeKernel(kernels_.add, cl::NullRange, cl::NDRange((pixels + local - 1) / local * local),
                                   cl::NDRange(local));
    }
    return times;
}

}  // namespace clarity
