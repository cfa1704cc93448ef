#include "render/tracers/rays/dynamic_fetch.hpp"

#include <algorithm>

namespace clarity {
namespace {

constexpr unsigned kFetchGroup = 64;
constexpr unsigned kGroupsPerUnit = 14;  // work-groups that run at the same time on a compute unit; an H200's runs 14
// Rays that a work-item fetches at a time. A fetch costs a warp one atomic operation. With many rays these operations cost more
// than the wait for the last rays at the end, so that a work-item then fetches two.
constexpr unsigned kManyEach = 1024 / 32;

}  // namespace

LaunchTimes DynamicFetch::trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                                cl_uint fields, const cl::Buffer& in, const cl::Buffer& out, OverflowCounter& overflows) {
    cl::CommandQueue& queue = device_->queue();
    const cl::Buffer before = queue_.get();
    const cl::Buffer& drawn = queue_.fit(device_->context(), 2 * sizeof(cl_uint));
    if (drawn() != before()) ping_pong_.forget();

    const unsigned most = std::max(1u, device_->info().compute_units) * kGroupsPerUnit;
    KernelArguments kernel = program.kernel();
    kernel.set("share", cl_uint(rays / (most * kFetchGroup) >= kManyEach ? 2 : 1));
    kernel.set("fields", fields).set("rays", in).set("answers", out).set("queue", drawn);
    overflows.bind(kernel);
    view.bind(*prepared.on_device, kernel);
    const auto enqueue = [&](unsigned begin, unsigned count) {
        kernel.set("first", cl_uint(begin * kFetchGroup));
        kernel.set("end", cl_uint(std::min(size_t(rays), (size_t(begin) + count) * kFetchGroup)));
        cl::Event event;
        ping_pong_.take([&](cl_uint) { queue.enqueueFillBuffer(drawn, cl_uint(0), 0, 2 * sizeof(cl_uint)); },
                        [&](cl_uint parity) {
                            kernel.set("parity", parity);
                            queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange,
                                                       cl::NDRange(size_t(std::min(count, most)) * kFetchGroup),
                                                       cl::NDRange(kFetchGroup), nullptr, &event);
                        });
        return Launcher::Piece{event, event};
    };
    const unsigned groups = (rays + kFetchGroup - 1) / kFetchGroup;
    return launcher_.run(*device_, queue, groups, groups, enqueue, [] {});
}

}  // namespace clarity
