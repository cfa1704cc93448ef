// launch.hpp -- running a kernel over work-groups in pieces short enough to be cancelled and not to trip a display driver.
#pragma once
#include <CL/opencl.hpp>
#include <functional>

#include "render/frame/pace.hpp"

namespace clarity {

struct LaunchTimes {
    double device_ms = 0, wall_ms = 0;
    unsigned launches = 0;
};

// What else is done about a picture that is traced; either may be missing.
struct Beside {
    std::function<cl::Event()> behind;     // enqueues what is to be done after the last kernel, and returns its last event
    std::function<void()> while_it_works;  // the host's, once, when the device has its first piece
};

// Keeps the pace of one kernel, or of several that run one after the other, from launch to launch.
class Launcher {
 public:
    // What was enqueued for one piece: its first and its last kernel.
    struct Piece {
        cl::Event first, last;
    };
    // Runs groups [0, group_count) in pieces of `most` at most, each enqueued by `enqueue`. go_on is asked between pieces and
    // stops by throwing. What is done behind is waited for with the last piece, and counts in none of the times.
    LaunchTimes run(cl::CommandQueue& queue, unsigned group_count, unsigned most,
                    const std::function<Piece(unsigned first, unsigned count)>& enqueue, const std::function<void()>& go_on,
                    const Beside& beside = {});
    // Runs groups [begin, begin + group_count) of `group_size` work-items; argument `first_argument` (a uint) is the number of
    // a piece's first group. Global offsets stay zero: PoCL compiles a kernel anew for others.
    LaunchTimes run(cl::CommandQueue& queue, cl::Kernel& kernel, cl_uint first_argument, unsigned group_count,
                    unsigned group_size, const std::function<void()>& go_on, unsigned begin = 0, const Beside& beside = {});
    void forget() { pace_.forget(); }
    // How long so many groups take; infinite where nothing is known.
    double expected_ms(unsigned groups) const { return pace_.expected_ms(groups); }

 private:
    Pace pace_;
};

}  // namespace clarity
