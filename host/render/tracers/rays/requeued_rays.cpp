#include "render/tracers/rays/requeued_rays.hpp"

#include <algorithm>

#include "render/kernels/kernel_source.hpp"

namespace clarity {
namespace {

constexpr unsigned kShortGroup = 64;         // of kernel trace_short
constexpr unsigned kLongGroupsPerUnit = 16;  // work-groups that run at the same time on a compute unit, or are ready to

}  // namespace

LaunchTimes RequeuedRays::trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                                bool any_hit, cl_uint fields, const cl::Buffer& in, const cl::Buffer& out,
                                OverflowCounter& overflows) {
    cl::CommandQueue& queue = device_->queue();
    const cl::Buffer before = list_.get();
    const cl::Buffer& list = list_.fit(device_->context(), (2 + size_t(rays)) * sizeof(cl_uint));
    if (list() != before()) ping_pong_.forget();

    cl::Kernel first = program.kernel(), rest(program.program, any_hit ? "trace_long_any" : "trace_long_closest");
    first.setArg(0, view.frame());
    first.setArg(2, cl_uint(rays));
    first.setArg(3, cl_uint(any_hit));
    first.setArg(4, fields);
    first.setArg(5, in);
    first.setArg(6, out);
    first.setArg(7, list);
    view.bind(*prepared.on_device, first, overflows.bind(first, 9, prepared.settings.debug));
    rest.setArg(0, view.frame());
    rest.setArg(1, fields);
    rest.setArg(2, in);
    rest.setArg(3, out);
    rest.setArg(4, list);
    view.bind(*prepared.on_device, rest, overflows.bind(rest, 6, prepared.settings.debug));

    const size_t long_items = size_t(std::max(1u, device_->info().compute_units)) * kLongGroupsPerUnit * kRequeueItems;
    const auto enqueue = [&](unsigned begin, unsigned count) {
        Launcher::Piece piece;
        first.setArg(1, cl_uint(begin));
        ping_pong_.take([&](cl_uint) { queue.enqueueFillBuffer(list, cl_uint(0), 0, 2 * sizeof(cl_uint)); },
                        [&](cl_uint parity) {
                            first.setArg(8, parity);
                            queue.enqueueNDRangeKernel(first, cl::NullRange, cl::NDRange(size_t(count) * kShortGroup),
                                                       cl::NDRange(kShortGroup), nullptr, &piece.first);
                            rest.setArg(5, parity);
                            queue.enqueueNDRangeKernel(rest, cl::NullRange, cl::NDRange(long_items), cl::NDRange(kRequeueItems),
                                                       nullptr, &piece.last);
                        });
        return piece;
    };
    const unsigned groups = (rays + kShortGroup - 1) / kShortGroup;
    return launcher_.run(*device_, queue, groups, groups, enqueue, [] {});
}

}  // namespace clarity
