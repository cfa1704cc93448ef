#include "device/queue.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace clarity {
namespace {

// A time of an event in us; negative: the driver does not know it.
double time_us(const cl::Event& event, cl_profiling_info what) {
    cl_ulong ns = 0;
    return clGetEventProfilingInfo(event(), what, sizeof ns, &ns, nullptr) == CL_SUCCESS ? 1e-3 * double(ns) : -1;
}

bool is_complete(const cl::Event& event) {
    cl_int status = CL_QUEUED;
    return clGetEventInfo(event(), CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr) == CL_SUCCESS &&
           status == CL_COMPLETE;
}

struct Command {
    timeline::Span span;   // by the device's clock, once the command is complete
    cl::Event event;       // until then
    double queued_us = 0;  // by the host's clock
    std::string track;
};

// The commands of one device. It has a clock of its own. A command is queued, by that clock, before its call returns, by ours:
// the least difference of all commands is nearest to that between the clocks.
struct Commands {
    std::map<cl_command_queue, size_t> number_of_queue;
    std::deque<Command> pending;  // in the order of their calls
    std::vector<Command> complete;
    double ahead_us = 1e300;
    size_t unknown = 0;

    void take(Command command) {
        timeline::Span& span = command.span;
        span.begin_us = time_us(command.event, CL_PROFILING_COMMAND_START);
        span.end_us = time_us(command.event, CL_PROFILING_COMMAND_END);
        const double queued = time_us(command.event, CL_PROFILING_COMMAND_QUEUED);
        command.event = cl::Event();
        if (span.begin_us < 0 || span.end_us < 0 || queued < 0) {
            ++unknown;
            return;
        }
        ahead_us = std::min(ahead_us, command.queued_us - queued);
        complete.push_back(std::move(command));
    }
    void take_complete() {
        while (!pending.empty() && is_complete(pending.front().event)) {
            take(std::move(pending.front()));
            pending.pop_front();
        }
    }
};

std::mutex devices_mutex;

// Never destroyed: an event that is not complete is never released, because a driver that is stuck would hang at that.
std::map<cl_device_id, Commands>& devices() {
    static auto& the = *new std::map<cl_device_id, Commands>;
    return the;
}

void add_all() {
    const std::lock_guard lock(devices_mutex);
    for (auto& [id, commands] : devices()) {
        commands.take_complete();
        for (Command& command : commands.complete) {
            command.span.begin_us += commands.ahead_us;
            command.span.end_us += commands.ahead_us;
            timeline::add(command.track, std::move(command.span));
        }
        timeline::leave_out(commands.pending.size() + commands.unknown);
        commands.complete.clear();
    }
}

}  // namespace

void Queue::note(timeline::Span span, const cl::Event& event) const {
    const double queued_us = timeline::now_us();
    const cl::Device device = getInfo<CL_QUEUE_DEVICE>();
    const std::lock_guard lock(devices_mutex);
    if (devices().empty()) timeline::before_writing(add_all);
    Commands& commands = devices()[device()];
    const size_t number = commands.number_of_queue.emplace((*this)(), commands.number_of_queue.size() + 1).first->second;
    commands.take_complete();
    Command& command = commands.pending.emplace_back();
    command.span = std::move(span);
    command.event = event;
    command.queued_us = queued_us;
    command.track = device.getInfo<CL_DEVICE_NAME>() + ", queue " + std::to_string(number);
}

}  // namespace clarity
