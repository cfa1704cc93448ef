#include "render/trial/trial_supervisor.hpp"

#include <unistd.h>

#include "base/error.hpp"
#include "worker/child.hpp"

namespace clarity {

TrialSupervisor::TrialSupervisor(worker::WorkerProcess& process, Progress& progress)
    : Supervisor(process, {worker::kTrialGreeting, "a trial worker", worker::worker_program(), Exit::kernel_build_failed},
                 progress) {}

void TrialSupervisor::handle(const worker::Message& message) {
    if (message.kind == worker::MessageKind::running) {
        step_ = message.text;
        limit_s_ = message.fraction > 0 && message.fraction < 1e9f ? double(message.fraction) : 60;
        made_progress();
    } else if (message.kind == worker::MessageKind::report) {
        not_tried_ = message.text;
    }
}

uint64_t TrialSupervisor::memory_limit_bytes() const {
    return static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) / 4 * 3;
}

void TrialSupervisor::ended(const worker::Ending& ending) const {
    using End = worker::Ending::Kind;
    const auto fail = [&](const std::string& what) { throw Error(Exit::kernel_build_failed, what + " while " + step_); };
    switch (ending.kind) {
        case End::crashed:
            fail("crashed (" + ending.how + ")");
            break;
        case End::no_progress:
            fail("did not come to an end within " + ending.how + " of processor time");
            break;
        case End::memory:
            fail("took more than " + ending.how + " of memory");
            break;
        case End::exited:
            fail("ended the process (" + ending.how + ")");
            break;
        default:
            fail("were killed from outside, maybe for want of memory,");
    }
}

}  // namespace clarity
