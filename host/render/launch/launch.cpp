#include "render/launch/launch.hpp"

#include <algorithm>
#include <chrono>

#include "base/elapsed.hpp"
#include "base/processor_time.hpp"
#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"

namespace clarity {

LaunchTimes Launcher::run(const Device& device, Queue& queue, unsigned group_count, unsigned most,
                          const std::function<Piece(unsigned first, unsigned count)>& enqueue,
                          const std::function<void()>& go_on, const SideWork& side_work) {
    LaunchTimes times;
    pace_.begin_picture();
    for (unsigned first = 0; first < group_count;) {
        go_on();
        const unsigned count = pace_.next(group_count - first, most);
        const auto start = std::chrono::steady_clock::now();
        const double used_ms = processor_ms();
        const Piece piece = enqueue(first, count);
        cl::Event last;
        if (side_work.behind && first + count == group_count) last = side_work.behind();
        if (side_work.while_it_works && times.launches == 0) {
            queue.flush();
            side_work.while_it_works();
        }
        queue.flush();
        wait_for(device, last() ? last : piece.last, [&] {
            return "a launch of " + std::to_string(count) + " of " + std::to_string(group_count) + " work-groups";
        });
        first += count;
        double wall = ms_since(start);
        const double traced = device.info().llvmpipe ? wall : span_ms(piece.first, piece.last, wall);  // its clock stands still
        if (last()) wall = std::max(traced, wall - std::max(0.0, span_ms(piece.first, last, traced) - traced));
        times.wall_ms += wall;
        times.device_ms += traced;
        times.processor_ms += processor_ms() - used_ms;
        ++times.launches;
        pace_.took(count, wall);
    }
    pace_.end_picture();
    return times;
}

LaunchTimes Launcher::run(const Device& device, Queue& queue, KernelArguments& kernel, unsigned group_count,
                          unsigned group_size, const std::function<void()>& go_on, unsigned begin, const SideWork& side_work) {
    const bool takes = kernel.has("taken");
    if (takes && !taken_known_) {
        cl_uint none = taken_before_ = 0;
        taken_ = cl::Buffer(queue.getInfo<CL_QUEUE_CONTEXT>(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof none, &none);
    }
    taken_known_ = false;  // after a launch that has not ended
    const auto enqueue = [&](unsigned first, unsigned count) {
        cl::Event event;
        kernel.set("first_group", cl_uint(begin + first));
        unsigned groups = count;
        if (takes) {
            const unsigned threads = std::max(1u, device.info().compute_units);
            // Threads that take shorter work wait for each other's taking; of larger shares they wait for the last one.
            constexpr double kShare_ms = 0.03;
            constexpr unsigned kSharesEach = 16;
            const double share = std::min(kShare_ms / (expected_ms(1) * threads), double(count) / (kSharesEach * threads));
            const unsigned share_groups = share > 1 ? unsigned(share) : 1, shares = (count + share_groups - 1) / share_groups;
            groups = std::min(shares, threads);
            kernel.set("group_count", cl_uint(count)).set("group_share", cl_uint(share_groups));
            kernel.set("taken_before", taken_before_).set("taken", taken_);
            taken_before_ += shares + groups;  // the last that each takes is none
        }
        queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(size_t(groups) * group_size),
                                   cl::NDRange(group_size), nullptr, &event);
        return Piece{event, event};
    };
    const LaunchTimes times = run(device, queue, group_count, group_count, enqueue, go_on, side_work);
    taken_known_ = takes;
    return times;
}

}  // namespace clarity
