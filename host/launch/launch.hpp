// launch.hpp -- runs a kernel over work-groups in pieces. A piece is short enough to cancel in time and not to trip a display
// driver.
#pragma once
#include <CL/opencl.hpp>
#include <functional>

#include "device/device.hpp"
#include "kernels/kernel_arguments.hpp"

namespace clarity {

// How many work-groups to launch at once.

// Pieces of a picture aim at 200 ms each. Drivers that also draw the desktop kill kernels after one or two seconds, and a
// running launch cannot be cancelled; 200 ms leaves room for parts of a picture that take longer than others. Later pictures
// use the pace of the slowest piece of the previous picture. For a first picture nothing is known, so its pieces begin small,
// grow by a factor and aim at 50 ms.
class Pace {
 public:
    void forget() { known_ = 0; }
    // Groups take so many times as long from now on.
    void slow_down(double times) { known_ /= times; }
    void begin_picture();
    // Returns the number of groups of the next piece: at least 1, at most `left` and `most`.
    unsigned next(unsigned left, unsigned most) const;
    // Records that a piece of so many groups took `ms`.
    void took(unsigned groups, double ms);
    // Expected time of that many groups, in ms; infinite if nothing is known.
    double expected_ms(unsigned groups) const;
    void end_picture();

 private:
    double known_ = 0;  // groups per ms, from the previous picture; 0: unknown
    // Of the current picture: pace of the slowest piece (groups per ms), totals, size of the last piece, number of pieces.
    double slowest_ = 0, all_groups_ = 0, all_ms_ = 0;
    unsigned last_ = 0, pieces_ = 0;
};

// Times in ms by the device's and the host's clock, and the number of launches. processor_ms: of a CPU, that of all threads of
// this process meanwhile: what the kernels took, however busy the machine is.
struct LaunchTimes {
    double device_ms = 0, wall_ms = 0, processor_ms = 0;
    unsigned launches = 0;
};

// Work beside the trace of a picture. Either function may be empty.
struct SideWork {
    std::function<cl::Event()> behind;     // enqueues work after the last kernel, and returns its last event
    std::function<void()> while_it_works;  // host work: called once, when the device has its first piece
};

// Runs one kernel, or several that belong together, and remembers from launch to launch how fast they are.
class Launcher {
 public:
    // The first and the last kernel that were enqueued for one piece.
    struct Piece {
        cl::Event first, last;
    };
    // Runs groups [0, group_count) in pieces of at most `most`. `enqueue` enqueues one piece. `go_on` is called between pieces
    // and stops the run by throwing. The call waits for side_work.behind with the last piece; its time is in none of the
    // returned times. queue: of the device. Throws Error(failed) if a piece does not end (device/launch_limit.hpp).
    LaunchTimes run(const Device& device, Queue& queue, unsigned group_count, unsigned most,
                    const std::function<Piece(unsigned first, unsigned count)>& enqueue, const std::function<void()>& go_on,
                    const SideWork& side_work = {});
    // Runs groups [begin, begin + group_count) of `group_size` work-items. The argument `first_group` (a uint) receives the
    // number of a piece's first group. Kernels with the argument `taken` take their groups by themselves (RT_FOR_GROUPS). The
    // global offset stays zero, because PoCL compiles a kernel again for another offset.
    LaunchTimes run(const Device& device, Queue& queue, KernelArguments& kernel, unsigned group_count, unsigned group_size,
                    const std::function<void()>& go_on, unsigned begin = 0, const SideWork& side_work = {});
    void forget() { pace_.forget(); }
    void slow_down(double times) { pace_.slow_down(times); }
    // Expected time of that many groups, in ms; infinite if nothing is known.
    double expected_ms(unsigned groups) const { return pace_.expected_ms(groups); }

 private:
    Pace pace_;
    // How many shares kernels have tried to take in all their launches, on the device and, so that nothing need clear it, here.
    // Null after a launch that has not ended: nobody knows what that one has taken.
    cl::Buffer taken_;
    cl_uint taken_before_ = 0;
};

}  // namespace clarity
