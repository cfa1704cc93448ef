#include "render/tracers/rays/requeued_rays.hpp"

#include <algorithm>

#include "render/tracers/rays/ray_kernels.hpp"

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

    KernelArguments first = program.kernel(), rest = program.kernel(any_hit ? "trace_long_any" : "trace_long_closest");
    first.set("count", cl_uint(rays)).set("any_hit", cl_uint(any_hit));
    for (KernelArguments* kernel : {&first, &rest}) {
        kernel->set("fields", fields).set("rays", in).set("answers", out).set("list", list);
        overflows.bind(*kernel);
        view.bind(*prepared.on_device, *kernel);
    }

    const size_t long_items = size_t(std::max(1u, device_->info().compute_units)) * kLongGroupsPerUnit * kRequeueItems;
    const auto enqueue = [&](unsigned begin, unsigned count) {
        Launcher::Piece piece;
        first.set("first_group", cl_uint(begin));
        ping_pong_.take([&](cl_uint) { queue.enqueueFillBuffer(list, cl_uint(0), 0, 2 * sizeof(cl_uint)); },
                        [&](cl_uint parity) {
                            first.set("parity", parity);
                            queue.enqueueNDRangeKernel(first.kernel(), cl::NullRange, cl::NDRange(size_t(count) * kShortGroup),
                                                       cl::NDRange(kShortGroup), nullptr, &piece.first);
                            rest.set("parity", parity);
                            queue.enqueueNDRangeKernel(rest.kernel(), cl::NullRange, cl::NDRange(long_items),
                                                       cl::NDRange(kRequeueItems), nullptr, &piece.last);
                        });
        return piece;
    };
    const unsigned groups = (rays + kShortGroup - 1) / kShortGroup;
    return launcher_.run(*device_, queue, groups, groups, enqueue, [] {});
}

}  // namespace clarity
