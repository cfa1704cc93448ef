#include "cli/interrupt.hpp"

#include <time.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "base/error.hpp"
#include "base/files/process_folder.hpp"

namespace clarity {
namespace {

std::atomic<Progress*> target{nullptr};
std::atomic<bool> came{false};
static_assert(std::atomic<Progress*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may touch nothing that locks");

// Sends SIGALRM when the time to stop is over. Made before the signal can come, because a handler may only start it.
timer_t deadline;
bool has_deadline = false;

void set_deadline(double seconds) {
    if (!has_deadline) return;
    itimerspec when{};
    when.it_value.tv_sec = static_cast<time_t>(seconds);
    when.it_value.tv_nsec = static_cast<long>((seconds - static_cast<double>(when.it_value.tv_sec)) * 1e9);
    timer_settime(deadline, 0, &when, nullptr);
}

void on_signal(int) {
    came = true;
    if (Progress* progress = target) progress->cancel();
    set_deadline(kStopSeconds);
}

char last_words[512] =
    "\nwarning: interrupted: the OpenCL driver did not stop, so the program was ended; nothing more is written\n";

// Nothing is lost by ending here: files have their names only when they are complete, and the kernel ends our workers with us.
void on_deadline(int) {
    const ssize_t written = ::write(STDERR_FILENO, last_words, std::strlen(last_words));
    (void)written;
    leave_process_folders();
    _exit(static_cast<int>(Exit::interrupted));
}

void make_deadline() {
    if (has_deadline) return;
    struct sigaction action{};
    action.sa_handler = on_deadline;
    sigevent event{};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGALRM;
    has_deadline = sigaction(SIGALRM, &action, nullptr) == 0 && timer_create(CLOCK_MONOTONIC, &event, &deadline) == 0;
}

}  // namespace

CancelOnSignal::CancelOnSignal(Progress& progress) {
    make_deadline();
    target = &progress;
    struct sigaction action{};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // SA_RESETHAND: the second signal ends the program
    for (const int signal : {SIGINT, SIGTERM}) {
        // A shell starts background jobs with SIGINT ignored; do not change that.
        struct sigaction old{};
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

void say_at_deadline(const std::string& text) {
    const std::string words = text.empty() ? text : "\nwarning: interrupted: " + text.substr(0, 480) + "\n";
    std::memcpy(last_words, words.c_str(), words.size() + 1);
}

void take_time_to_stop() {
    set_deadline(0);
}

}  // namespace clarity
