#include "device/launch_limit.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <thread>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "device/cl_errors.hpp"

namespace clarity {
namespace {

// The driver's own wait would spin for short launches, too. Later the thread sleeps for a small part of the time that has
// passed, so that a launch seems at most 1 % longer.
constexpr double kSpin_s = 0.004, kSleepShare = 1.0 / 128, kLongestSleep_s = 0.005;

[[noreturn]] void give_up(const Device& device, const std::string& what, double seconds) {
    device.loss()->note_stuck();
    char after[40];
    std::snprintf(after, sizeof after, "%.3g s", seconds);
    throw Error(Exit::failed, what + " has not come to an end on " + device.info().name + " after " + after +
                                  ", and no call can stop it: the device is given up. If it loops for ever, mend the kernel or "
                                  "take another structure or tracer; if it is only slow, raise CLARITY_LAUNCH_LIMIT");
}

}  // namespace

double launch_limit_s() {
    static const double limit = [] {
        const char* text = std::getenv("CLARITY_LAUNCH_LIMIT");
        char* end = nullptr;
        const double seconds = text ? std::strtod(text, &end) : 20;
        if (text && (end == text || *end || !(seconds >= 0))) return 20.0;
        return seconds > 0 ? seconds : std::numeric_limits<double>::infinity();
    }();
    return limit;
}

void wait_for(const Device& device, const cl::Event& event, const std::function<std::string()>& what) {
    if (device.info().cpu) {
        event.wait();
        return;
    }
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
        cl_int status = CL_COMPLETE;
        const cl_int error = clGetEventInfo(event(), CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr);
        if (error != CL_SUCCESS) throw cl::Error(error, "clGetEventInfo");
        if (status == CL_COMPLETE) return;
        if (status < 0) throw cl::Error(status, "the work");
        const double seconds = seconds_since(begin);
        if (seconds > launch_limit_s()) give_up(device, what(), seconds);
        if (seconds < kSpin_s)
            std::this_thread::yield();
        else
            std::this_thread::sleep_for(std::chrono::duration<double>(std::min(seconds * kSleepShare, kLongestSleep_s)));
    }
}

void wait_for(const Device& device, const cl::Event& event, const char* what) {
    wait_for(device, event, [what] { return std::string(what); });
}

void finish(const Device& device, Queue& queue, const char* what) {
    if (device.info().cpu) {
        queue.finish();
        return;
    }
    cl::Event end;
    queue.enqueueMarkerWithWaitList(nullptr, &end);
    queue.flush();
    wait_for(device, end, what);
}

}  // namespace clarity
