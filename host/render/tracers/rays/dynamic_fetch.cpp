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
    cl::Kernel kernel = program.kernel();
    kernel.setArg(0, view.frame());
    kernel.setArg(3, cl_uint(rays / (most * kFetchGroup) >= kManyEach ? 2 : 1));
    kernel.setArg(4, fields);
    kernel.setArg(5, in);
    kernel.setArg(6, out);
    kernel.setArg(7, drawn);
    view.bind(*prepared.on_device, kernel, overflows.bind(kernel, 9, prepared.settings.debug));
    const auto enqueue = [&](unsigned begin, unsigned count) {
        kernel.setArg(1, cl_uint(begin * kFetchGroup));
        kernel.setArg(2, cl_uint(std::min(size_t(rays), (size_t(begin) + count) * kFetchGroup)));
        cl::Event event;
        ping_pong_.take([&](cl_uint) { queue.enqueueFillBuffer(drawn, cl_uint(0), 0, 2 * sizeof(cl_uint)); },
                        [&](cl_uint parity) {
                            kernel.setArg(8, parity);
                            queue.enqueueNDRangeKernel(kernel, cl::NullRange,
                                                       cl::NDRange(size_t(std::min(count, most)) * kFetchGroup),
                                                       cl::NDRange(kFetchGroup), nullptr, &event);
                        });
        return Launcher::Piece{event, event};
    };
    const unsigned groups = (rays + kFetchGroup - 1) / kFetchGroup;
    return launcher_.run(*device_, queue, groups, groups, enqueue, [] {});
}

}  // namespace clarity
