#include "render/launch.hpp"

#include <algorithm>
#include <chrono>

namespace clarity {
namespace {
constexpr double kPieceMs = 200;      // drivers that also draw the desktop kill kernels after a second or two
constexpr unsigned kFirstPiece = 64;  // groups, while nothing is known
constexpr unsigned kGrowth = 8;
}  // namespace

LaunchTimes Launcher::run(cl::CommandQueue& queue, unsigned group_count, unsigned most,
                          const std::function<Piece(unsigned first, unsigned count)>& enqueue,
                          const std::function<void()>& go_on) {
    LaunchTimes times;
    unsigned guess = kFirstPiece;
    for (unsigned first = 0; first < group_count;) {
        go_on();
        unsigned count = groups_per_ms_ > 0 ? static_cast<unsigned>(std::min(groups_per_ms_ * kPieceMs, 4e9)) : guess;
        count = std::clamp(count, 1u, std::min(most, group_count - first));
        const unsigned left = group_count - first - count;
        if (left < count / 2 && count + left <= most) count += left;  // no crumbs
        const auto start = std::chrono::steady_clock::now();
        const Piece piece = enqueue(first, count);
        queue.finish();
        const double wall = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        times.wall_ms += wall;
        times.device_ms += 1e-6 * double(piece.last.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                         piece.first.getProfilingInfo<CL_PROFILING_COMMAND_START>());
        first += count;
        ++times.launches;
        // A slow first piece may hold a compilation, so a pace is believed once pieces take a while.
        if (wall > 5 || first == group_count) groups_per_ms_ = count / std::max(wall, 1e-3);
        guess = std::min(guess * kGrowth, group_count);
    }
    return times;
}

LaunchTimes Launcher::run(cl::CommandQueue& queue, cl::Kernel& kernel, cl_uint first_argument, unsigned group_count,
                          unsigned group_size, const std::function<void()>& go_on, unsigned begin) {
    const auto enqueue = [&](unsigned first, unsigned count) {
        cl::Event event;
        kernel.setArg(first_argument, begin + first);
        queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(size_t(count) * group_size), cl::NDRange(group_size),
                                   nullptr, &event);
        return Piece{event, event};
    };
    return run(queue, group_count, group_count, enqueue, go_on);
}

}  // namespace clarity
