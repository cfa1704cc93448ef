#include "worker/supervisor.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>

#include "base/log.hpp"
#include "base/lower.hpp"
#include "base/memory_text.hpp"

namespace clarity::worker {
namespace {

constexpr double kPollSeconds = 0.02;
constexpr double kGreetingSeconds = 5;  // our worker sends its greeting within milliseconds, also on a loaded machine
constexpr double kCancelGraceSeconds = 0.05;
constexpr size_t kMaxOutputLines = 200;
constexpr uint64_t kMemorySlack = uint64_t(256) << 20;  // bytes of the program itself

}  // namespace

std::string in_words(double seconds) {
    const auto tenths = static_cast<uint64_t>(std::lround(seconds * 10));
    return std::to_string(tenths / 10) + (tenths % 10 != 0 ? "." + std::to_string(tenths % 10) : "") + " s";
}

void Supervisor::follow() {
    while (!done_) {
        std::array<pollfd, 2> ready = {pollfd{worker_.channel(), POLLIN, 0}, pollfd{worker_.output(), POLLIN, 0}};
        poll(ready.data(), output_open_ ? 2 : 1, static_cast<int>(1000 * kPollSeconds));
        forward_output();
        const bool alive = read_messages();
        if (progress_.cancelled()) stop_on_cancel();
        if (!alive && !done_) {
            const int status = worker_.wait();
            forward_last_output();
            explain_death(status);
        }
        if (!done_) watch();
    }
    forward_last_output();
}

// Returns false once the worker has closed its end, which happens when it dies.
bool Supervisor::read_messages() {
    Message message;
    // Read a limited number, so that a flood of messages cannot keep us from checking the time.
    for (int i = 0; i < 1000 && !done_; ++i) {
        switch (receive_message(worker_.channel(), message)) {
            case Received::nothing:
                return true;
            case Received::closed:
                return false;
            case Received::message:
                take(message);
        }
    }
    return true;
}

void Supervisor::take(const Message& message) {
    if (!greeted_) {
        if (message.kind != MessageKind::greeting || message.text != kind_.greeting) {
            throw Error(kind_.code, kind_.program + ": is no " + (std::strchr(kind_.name, ' ') + 1) +
                                        " of this version of clarity; name the right program in CLARITY_WORKER or unset it");
        }
        greeted_ = true;
    }
    switch (message.kind) {
        case MessageKind::stage:
            progress_.stage(message.text);
            fraction_ = -1;
            made_progress();
            break;
        case MessageKind::progress:
            // A report counts as progress only if the fraction has grown.
            if (std::isfinite(message.fraction) && message.fraction > fraction_ + 0.001f) {
                fraction_ = message.fraction;
                made_progress();
            }
            progress_.report(message.fraction);
            break;
        case MessageKind::log:
            log(static_cast<LogLevel>(std::clamp(message.level, 0, static_cast<int>(LogLevel::warning))), message.text);
            break;
        case MessageKind::death:
            last_words_ = message.text;
            break;
        case MessageKind::failed:
            if (progress_.cancelled()) throw Cancelled();
            forward_last_output();
            throw Error(kind_.code, message.text);
        case MessageKind::cancelled:
            throw Cancelled();
        case MessageKind::done:
            done_ = true;
            break;
        default:
            handle(message);
    }
}

// Logs what libraries print.
void Supervisor::forward_output() {
    std::array<char, 4096> buffer;
    for (ssize_t bytes = 0; output_open_ && (bytes = read(worker_.output(), buffer.data(), buffer.size())) != -1;) {
        if (bytes == 0) output_open_ = false;
        line_.append(buffer.data(), static_cast<size_t>(bytes));
        for (size_t end = line_.find('\n'); end != std::string::npos || line_.size() > 1000; end = line_.find('\n')) {
            const std::string text = line_.substr(0, std::min(end, size_t(1000)));
            line_.erase(0, end == std::string::npos ? text.size() : end + 1);
            if (++output_lines_ <= kMaxOutputLines) printed(text);
        }
        if (output_lines_ > kMaxOutputLines) break;  // read once per round only, so that a flood cannot hold us up
    }
}

// The rest, at the end of the worker: its last line may have no newline.
void Supervisor::forward_last_output() {
    forward_output();
    if (!line_.empty() && ++output_lines_ <= kMaxOutputLines) printed(line_);
    line_.clear();
}

void Supervisor::made_progress() {
    idle_s_ = 0;
    busy_from_s_ = worker_.processor_s();
}

void Supervisor::printed(const std::string& line) {
    log(LogLevel::debug, speaker() + " printed: " + line);
}

void Supervisor::stop_on_cancel() {
    send_message(worker_.channel(), {MessageKind::cancel, 0, 0, {}});
    pollfd closed = {worker_.channel(), POLLIN, 0};
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kCancelGraceSeconds);
    Message message;
    for (bool open = true; open && std::chrono::steady_clock::now() < end;) {
        poll(&closed, 1, 5);
        open = receive_message(worker_.channel(), message) != Received::closed;
    }
    worker_.kill_now();
    throw Cancelled();
}

void Supervisor::watch() {
    watched();
    // Time in which this process itself did not run (suspended, stopped in a terminal) does not count against the worker.
    const auto now = std::chrono::steady_clock::now();
    const double passed_s = std::min(std::chrono::duration<double>(now - last_look_).count(), 0.5);
    last_look_ = now;
    idle_s_ += passed_s;
    if (!greeted_ && idle_s_ > kGreetingSeconds) {
        throw Error(kind_.code, kind_.program + ": does not answer as " + kind_.name +
                                    "; name the program `clarity` in CLARITY_WORKER or unset it");
    }
    const double busy_s = worker_.processor_s() - busy_from_s_;
    const bool by_processor = counts_processor_time();
    if (idle_s_ > (by_processor ? kWaitFactor : 1) * idle_limit_s() || (by_processor && busy_s > idle_limit_s()))
        ended({Ending::Kind::no_progress, in_words(idle_limit_s())});
    // The memory that a worker may map is limited already, where no driver reserves addresses. Its resident memory is what
    // counts.
    memory_look_s_ += passed_s;
    if (memory_look_s_ < 0.1) return;
    memory_look_s_ = 0;
    if (worker_.resident_bytes() > memory_limit_bytes() + kMemorySlack)
        ended({Ending::Kind::memory, memory_limit_text(memory_limit_bytes())});
}

void Supervisor::explain_death(int status) const {
    if (!greeted_) {
        throw Error(kind_.code, kind_.program + ": ended without answering as " + kind_.name +
                                    "; name the program `clarity` in CLARITY_WORKER or unset it");
    }
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (last_words_ == "out of memory") return ended({Ending::Kind::memory, memory_limit_text(memory_limit_bytes())});
    if (WIFEXITED(status)) return ended({Ending::Kind::exited, "exit code " + std::to_string(WEXITSTATUS(status))});
    if (signal == SIGXCPU) return ended({Ending::Kind::processor_time, in_words(static_cast<double>(processor_limit_s()))});
    if (signal == SIGKILL) return ended({Ending::Kind::killed, {}});
    const char* name = strsignal(signal);
    std::string how = name ? name : "signal " + std::to_string(signal);
    how.front() = lower(how.front());
    if (!last_words_.empty()) how += ": " + last_words_;
    ended({Ending::Kind::crashed, how});
}

}  // namespace clarity::worker
