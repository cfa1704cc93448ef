// ray_launches.cpp -- how the kernels of ray queries are launched.
#include <algorithm>

#include "tracers/rays/ray_kernels.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity {
namespace {

constexpr unsigned kGroup = 64;               // work-items of kernels whose work-items trace one ray each
constexpr unsigned kLongGroupsPerUnit = 16;   // work-groups that run at the same time on a compute unit, or are ready to
constexpr unsigned kFetchGroupsPerUnit = 14;  // of trace_dynamic_fetch; an H200's unit runs 14
// Rays that a work-item fetches at a time. A fetch costs a warp one atomic operation. With many rays these operations cost more
// than the wait for the last rays at the end, so that a work-item then fetches two.
constexpr unsigned kManyEach = 1024 / 32;

}  // namespace

const cl::Buffer& RayQueries::Counted::fit(const cl::Context& context, size_t rays) {
    const cl::Buffer before = buffer.get();
    const cl::Buffer& fitting = buffer.fit(context, (2 + rays) * sizeof(cl_uint));
    if (fitting() != before()) parity.forget();
    return fitting;
}

void RayQueries::Counted::take(Queue& queue, const std::function<void(cl_uint parity)>& enqueue) {
    parity.take([&](cl_uint) { queue.enqueueFillBuffer(buffer.get(), cl_uint(0), 0, 2 * sizeof(cl_uint)); }, enqueue);
}

KernelArguments& RayQueries::kernel_of(const Launch& launch, const char* entry) {
    const auto [found, fresh] = looked_up_.kernels.try_emplace({&launch.program, entry ? entry : ""});
    KernelArguments& kernel = found->second;
    if (fresh) {
        kernel = launch.program.kernel(entry);
        view_.bind(*launch.prepared.on_device, kernel);
    }
    kernel.set("fields", launch.answers.fields)
        .set("stride", cl_uint(launch.answers.stride))
        .set("before", cl_uint(launch.answers.before));
    kernel.set("rays", launch.in).set("answers", launch.answers.buffer);
    if (kernel.has("any_hit")) kernel.set("any_hit", cl_uint(launch.any_hit));
    overflows_.bind(kernel);
    return kernel;
}

LaunchTimes RayQueries::trace(const Launch& launch) {
    const KernelRow& row = launch.program.row;
    return &row == &requeued_rays()   ? trace_requeued(launch)
           : &row == &dynamic_fetch() ? trace_fetching(launch)
                                      : trace_at_once(launch);
}

LaunchTimes RayQueries::trace_at_once(const Launch& launch) {
    const Layout& layout = launch.prepared.layout;
    const unsigned each = launch.program.row.rays_per_item;
    KernelArguments& kernel = kernel_of(launch);
    kernel.set(each ? "count" : "blocks", cl_uint(launch.blocks));
    const unsigned in_group = each ? layout.local_size() * each : layout.group_packets() * layout.blocks();
    return launch.launcher.run(
        *device_, device_->queue(), kernel, (launch.blocks + in_group - 1) / in_group, layout.local_size(),
        [&] { launch.go_on(); }, 0, launch.side_work);
}

LaunchTimes RayQueries::trace_requeued(const Launch& launch) {
    Queue& queue = device_->queue();
    const cl::Buffer& list = long_rays_.fit(device_->context(), launch.blocks);
    KernelArguments& first = kernel_of(launch);
    KernelArguments& rest = kernel_of(launch, launch.any_hit ? "trace_long_any" : "trace_long_closest");
    first.set("count", cl_uint(launch.blocks)).set("list", list);
    rest.set("list", list);
    const size_t long_items = size_t(std::max(1u, device_->info().compute_units)) * kLongGroupsPerUnit * kRequeueItems;
    const auto enqueue = [&](unsigned begin, unsigned count) {
        Launcher::Piece piece;
        first.set("first_group", cl_uint(begin));
        long_rays_.take(queue, [&](cl_uint parity) {
            first.set("parity", parity);
            queue.enqueueNDRangeKernel(first.kernel(), cl::NullRange, cl::NDRange(size_t(count) * kGroup), cl::NDRange(kGroup),
                                       nullptr, &piece.first);
            rest.set("parity", parity);
            queue.enqueueNDRangeKernel(rest.kernel(), cl::NullRange, cl::NDRange(long_items), cl::NDRange(kRequeueItems),
                                       nullptr, &piece.last);
        });
        return piece;
    };
    const unsigned groups = (launch.blocks + kGroup - 1) / kGroup;
    return launch.launcher.run(*device_, queue, groups, groups, enqueue, [&] { launch.go_on(); }, launch.side_work);
}

LaunchTimes RayQueries::trace_fetching(const Launch& launch) {
    Queue& queue = device_->queue();
    const unsigned most = std::max(1u, device_->info().compute_units) * kFetchGroupsPerUnit;
    KernelArguments& kernel = kernel_of(launch);
    kernel.set("share", cl_uint(launch.blocks / (most * kGroup) >= kManyEach ? 2 : 1));
    kernel.set("queue", fetched_.fit(device_->context(), 0));
    const auto enqueue = [&](unsigned begin, unsigned count) {
        kernel.set("first", cl_uint(begin * kGroup));
        kernel.set("end", cl_uint(std::min(size_t(launch.blocks), (size_t(begin) + count) * kGroup)));
        cl::Event event;
        fetched_.take(queue, [&](cl_uint parity) {
            kernel.set("parity", parity);
            queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(size_t(std::min(count, most)) * kGroup),
                                       cl::NDRange(kGroup), nullptr, &event);
        });
        return Launcher::Piece{event, event};
    };
    const unsigned groups = (launch.blocks + kGroup - 1) / kGroup;
    return launch.launcher.run(*device_, queue, groups, groups, enqueue, [&] { launch.go_on(); }, launch.side_work);
}

}  // namespace clarity
