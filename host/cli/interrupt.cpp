#include "cli/interrupt.hpp"

#include <csignal>

namespace clarity {
namespace {

std::atomic<Progress*> target{nullptr};
std::atomic<bool> came{false};
static_assert(std::atomic<Progress*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may touch nothing that locks");

void on_signal(int) {
    came = true;
    if (Progress* progress = target) progress->cancel();
}

}  // namespace

CancelOnSignal::CancelOnSignal(Progress& progress) {
    target = &progress;
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // SA_RESETHAND: the second signal ends the program
    for (const int signal : {SIGINT, SIGTERM}) {
        // A shell starts background jobs with SIGINT ignored; do not change that.
        struct sigaction old {};
        if (sigaction(signal, nullptr, &old) == 0 && old.sa_handler == SIG_IGN) continue;
        sigaction(signal, &action, nullptr);
    }
}

CancelOnSignal::~CancelOnSignal() {
    target = nullptr;
}

bool interrupted() {
    return came;
}

}  // namespace clarity
