#include "render/launch.hpp"

#include <algorithm>
#include <chrono>

#include "render/guarded.hpp"

namespace clarity {
namespace {
constexpr double kPieceMs = 200;      // drivers that also draw the desktop kill kernels after a second or two
constexpr unsigned kFirstPiece = 64;  // groups, while nothing is known
constexpr unsigned kGrowth = 8;
}  // namespace

LaunchTimes Launcher::run(cl::CommandQueue& queue, cl::Kernel& kernel, cl_uint first_argument, unsigned group_count,
                          unsigned group_size, const std::function<void()>& go_on, unsigned begin) {
    LaunchTimes times;
    unsigned guess = kFirstPiece;
    for (unsigned first = 0; first < group_count;) {
        go_on();
        unsigned count = groups_per_ms_ > 0 ? static_cast<unsigned>(std::min(groups_per_ms_ * kPieceMs, 4e9)) : guess;
        count = std::clamp(count, 1u, group_count - first);
        if (group_count - first - count < count / 2) count = group_count - first;  // no crumbs
        kernel.setArg(first_argument, begin + first);
        const auto start = std::chrono::steady_clock::now();
        cl::Event event;
        queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(size_t(count) * group_size), cl::NDRange(group_size),
                                   nullptr, &event);
        queue.finish();
        const double wall = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        times.wall_ms += wall;
        times.device_ms += event_ms(event, wall);
        first += count;
        ++times.launches;
        // A slow first piece may hold a compilation, so a pace is believed once pieces take a while.
        if (wall > 5 || first == group_count) groups_per_ms_ = count / std::max(wall, 1e-3);
        guess = std::min(guess * kGrowth, group_count);
    }
    return times;
}

}  // namespace clarity
