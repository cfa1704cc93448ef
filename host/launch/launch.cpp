#include "launch/launch.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "base/elapsed.hpp"
#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"

namespace clarity {
namespace {

constexpr double kPieceMs = 200, kFirstPieceMs = 50;
constexpr unsigned kFirstGroups = 4, kGrowth = 4;
constexpr double kTellingMs = 5;  // shorter pieces mostly measure the launch itself

// How many groups a thread takes at a time. Of short ones it takes several, because threads wait for each other's taking; of
// large shares they would wait for the last one. group_ms: of one group, by all threads together; infinite: not known.
unsigned groups_of_share(unsigned groups, unsigned threads, double group_ms) {
    constexpr double kShare_ms = 0.03;
    constexpr unsigned kSharesEach = 16;
    const double share = std::min(kShare_ms / (group_ms * threads), double(groups) / (kSharesEach * threads));
    return share > 1 ? unsigned(share) : 1;
}

}  // namespace

LaunchTimes Launcher::run(const Device& device, Queue& queue, unsigned group_count, unsigned most,
                          const std::function<Piece(unsigned first, unsigned count)>& enqueue,
                          const std::function<void()>& go_on, const SideWork& side_work) {
    LaunchTimes times;
    pace_.begin_picture();
    for (unsigned first = 0; first < group_count;) {
        go_on();
        const unsigned count = pace_.next(group_count - first, most);
        const auto start = std::chrono::steady_clock::now();
        const double used_ms = device.info().cpu ? processor_ms() : 0;
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
        if (device.info().cpu) times.processor_ms += processor_ms() - used_ms;
        ++times.launches;
        pace_.took(count, wall);
    }
    pace_.end_picture();
    return times;
}

LaunchTimes Launcher::run(const Device& device, Queue& queue, KernelArguments& kernel, unsigned group_count,
                          unsigned group_size, const std::function<void()>& go_on, unsigned begin, const SideWork& side_work) {
    const bool takes = kernel.has("taken");
    cl::Buffer taken = std::exchange(taken_, cl::Buffer());
    if (takes && !taken()) {
        cl_uint none = taken_before_ = 0;
        taken = cl::Buffer(queue.getInfo<CL_QUEUE_CONTEXT>(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof none, &none);
    }
    const auto enqueue = [&](unsigned first, unsigned count) {
        cl::Event event;
        kernel.set("first_group", cl_uint(begin + first));
        unsigned groups = count;
        if (takes) {
            const unsigned threads = std::max(1u, device.info().compute_units);
            const unsigned share = groups_of_share(count, threads, expected_ms(1)), shares = (count + share - 1) / share;
            groups = std::min(shares, threads);
            kernel.set("group_count", cl_uint(count)).set("group_share", cl_uint(share));
            kernel.set("taken_before", taken_before_).set("taken", taken);
            taken_before_ += shares + groups;  // the last that each takes is none
        }
        queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(size_t(groups) * group_size),
                                   cl::NDRange(group_size), nullptr, &event);
        return Piece{event, event};
    };
    const LaunchTimes times = run(device, queue, group_count, group_count, enqueue, go_on, side_work);
    taken_ = taken;
    return times;
}

void Pace::begin_picture() {
    slowest_ = all_groups_ = all_ms_ = 0;
    last_ = pieces_ = 0;
}

unsigned Pace::next(unsigned left, unsigned most) const {
    double pace = slowest_ > 0 ? slowest_ : known_;
    if (known_ > 0) pace = std::min(pace, known_);
    double groups = pace > 0 ? pace * (known_ > 0 ? kPieceMs : kFirstPieceMs) : 4e9;
    if (known_ <= 0) groups = std::min(groups, double(last_ > 0 ? last_ * double(kGrowth) : kFirstGroups));
    const auto count = std::clamp(static_cast<unsigned>(std::min(groups, 4e9)), 1u, std::min(left, most));
    const unsigned rest = left - count;
    return known_ > 0 && rest < count / 2 && count + rest <= most ? left : count;  // no small rest
}

void Pace::took(unsigned groups, double ms) {
    const double at_least = std::max(ms, 1e-3);
    // The very first launch may include a compilation, so its time is not used. If it was long, the next piece has the smallest
    // size.
    const bool first = known_ <= 0 && pieces_++ == 0;
    last_ = first && ms > kFirstPieceMs ? 1 : groups;
    if (first) return;
    all_groups_ += groups;
    all_ms_ += at_least;
    if (ms > kTellingMs) slowest_ = slowest_ > 0 ? std::min(slowest_, groups / at_least) : groups / at_least;
}

double Pace::expected_ms(unsigned groups) const {
    return known_ > 0 ? groups / known_ : std::numeric_limits<double>::infinity();
}

void Pace::end_picture() {
    if (slowest_ > 0)
        known_ = slowest_;
    else if (all_ms_ > 0)
        known_ = all_groups_ / all_ms_;
}

}  // namespace clarity
