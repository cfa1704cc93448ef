#include "worker/job.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <string_view>

#include "base/text.hpp"
#include "base/timeline.hpp"

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

std::string Job::worker_name() const {
    return std::string(std::strchr("aeiou", kind_.name[0]) ? "an " : "a ") + kind_.name + " worker";
}

void Job::follow(const MemoryFile& arguments, Progress& progress) {
    const timeline::Scope span("worker",
                               [&] { return std::string(kind_.name) + " worker" + (what_.empty() ? "" : ": " + what_); });
    progress_ = &progress;
    std::vector<std::string> words = {program};
    words.insert(words.end(), words_before.begin(), words_before.end());
    words.insert(words.end(), {std::string(kind_.name) + kCommandEnd, std::to_string(getpid())});
    if (!subject.empty()) words.push_back(subject);
    process_.emplace(words, arguments, kind_.code);
    last_look_ = std::chrono::steady_clock::now();
    while (!done_) {
        std::array<pollfd, 2> ready = {pollfd{process_->channel(), POLLIN, 0}, pollfd{process_->output(), POLLIN, 0}};
        poll(ready.data(), output_open_ ? 2 : 1, static_cast<int>(1000 * kPollSeconds));
        forward_output();
        const bool alive = read_messages();
        if (progress.cancelled()) stop_on_cancel();
        if (!alive && !done_) {
            const int status = process_->wait();
            forward_last_output();
            explain_death(status);
        }
        if (!done_) look_at_limits();
    }
    forward_last_output();
}

// Returns false once the worker has closed its end, which happens when it dies.
bool Job::read_messages() {
    Message message;
    // Read a limited number, so that a flood of messages cannot keep us from checking the time.
    for (int i = 0; i < 1000 && !done_; ++i) {
        switch (receive_message(process_->channel(), message)) {
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

void Job::take(const Message& message) {
    if (!greeted_) {
        if (message.kind != MessageKind::greeting || message.text != greeting_of(kind_.name)) {
            throw Error(kind_.code,
                        program + ": is no " + kind_.name +
                            " worker of this version of clarity; name the right program in CLARITY_WORKER or unset it");
        }
        greeted_ = true;
    }
    switch (message.kind) {
        case MessageKind::stage:
            progress_->stage(message.text);
            fraction_ = -1;
            made_progress();
            break;
        case MessageKind::progress:
            // A report counts as progress only if the fraction has grown.
            if (std::isfinite(message.fraction) && message.fraction > fraction_ + 0.001f) {
                fraction_ = message.fraction;
                made_progress();
            }
            progress_->report(message.fraction);
            break;
        case MessageKind::log:
            log(static_cast<LogLevel>(std::clamp(message.level, 0, static_cast<int>(LogLevel::warning))), message.text);
            break;
        case MessageKind::running:
            if (message.fraction > 0 && message.fraction < 1e9f) limits_.idle_s = double(message.fraction);
            made_progress();
            on_step(message.text);
            break;
        case MessageKind::report:
            made_progress();
            on_report(message.text);
            break;
        case MessageKind::death:
            last_words_ = message.text;
            memory_refused_ = false;
            break;
        case MessageKind::no_memory:
            memory_refused_ = true;
            break;
        case MessageKind::failed:
            if (progress_->cancelled()) throw Cancelled();
            forward_last_output();
            throw Error(kind_.code, message.text)
                .as(static_cast<Failure>(std::clamp(message.level, 0, static_cast<int>(kLastFailure))));
        case MessageKind::cancelled:
            throw Cancelled();
        case MessageKind::done:
            done_ = true;
            break;
        default:
            break;
    }
}

// Logs what libraries print.
void Job::forward_output() {
    std::array<char, 4096> buffer;
    for (ssize_t bytes = 0; output_open_ && (bytes = read(process_->output(), buffer.data(), buffer.size())) != -1;) {
        if (bytes == 0) output_open_ = false;
        line_.append(buffer.data(), static_cast<size_t>(bytes));
        for (size_t end = line_.find('\n'); end != std::string::npos || line_.size() > 1000; end = line_.find('\n')) {
            const std::string text = line_.substr(0, std::min(end, size_t(1000)));
            line_.erase(0, end == std::string::npos ? text.size() : end + 1);
            if (++output_lines_ <= kMaxOutputLines) on_output(text);
        }
        if (output_lines_ > kMaxOutputLines) break;  // read once per round only, so that a flood cannot hold us up
    }
}

// The rest, at the end of the worker: its last line may have no newline.
void Job::forward_last_output() {
    forward_output();
    if (!line_.empty() && ++output_lines_ <= kMaxOutputLines) on_output(line_);
    line_.clear();
}

void Job::made_progress() {
    idle_s_ = 0;
    busy_from_s_ = process_->processor_s();
}

void Job::on_output(const std::string& line) {
    log(kind_.output_level, who_ + " printed: " + printable_line(line));
}

void Job::stop_on_cancel() {
    send_message(process_->channel(), {MessageKind::cancel, 0, 0, {}});
    pollfd closed = {process_->channel(), POLLIN, 0};
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kCancelGraceSeconds);
    Message message;
    for (bool open = true; open && std::chrono::steady_clock::now() < end;) {
        poll(&closed, 1, 5);
        open = receive_message(process_->channel(), message) != Received::closed;
    }
    process_->kill_now();
    throw Cancelled();
}

void Job::look_at_limits() {
    watch();
    // Time in which this process itself did not run (suspended, stopped in a terminal) does not count against the worker.
    const auto now = std::chrono::steady_clock::now();
    const double passed_s = std::min(std::chrono::duration<double>(now - last_look_).count(), 0.5);
    last_look_ = now;
    idle_s_ += passed_s;
    if (!greeted_ && idle_s_ > kGreetingSeconds) no_worker("does not answer");
    const double busy_s = process_->processor_s() - busy_from_s_;
    const bool by_processor = kind_.counts_processor_time;
    if (idle_s_ > (by_processor ? kWaitFactor : 1) * limits_.idle_s || (by_processor && busy_s > limits_.idle_s))
        died(Cause::no_progress, in_words(limits_.idle_s));
    // The memory that a worker may map is limited already, where no driver reserves addresses. Its resident memory is what
    // counts.
    memory_look_s_ += passed_s;
    if (memory_look_s_ < 0.1) return;
    memory_look_s_ = 0;
    if (process_->resident_bytes() > limits_.memory_bytes + kMemorySlack)
        died(Cause::memory, memory_limit_text(limits_.memory_bytes));
}

void Job::explain_death(int status) const {
    if (!greeted_) no_worker("ended without answering");
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (memory_refused_) died(Cause::memory, memory_limit_text(limits_.memory_bytes));
    if (WIFEXITED(status)) died(Cause::exited, "exit code " + std::to_string(WEXITSTATUS(status)));
    if (signal == SIGXCPU) died(Cause::processor_time, in_words(static_cast<double>(limits_.processor_s)));
    if (signal == SIGKILL) died(Cause::killed, {});
    const char* name = strsignal(signal);
    std::string how = name ? name : "signal " + std::to_string(signal);
    how.front() = lower(how.front());
    if (!last_words_.empty()) how += ": " + last_words_;
    died(Cause::crashed, how);
}

void Job::died(Cause cause, const std::string& how) const {
    const std::pair<std::string_view, const std::string&> places[] = {
        {"{how}", how}, {"{who}", who_}, {"{what}", what_}, {"{step}", step_}, {"{advice}", advice}};
    std::string message;
    for (std::string_view left = kind_.deaths[static_cast<size_t>(cause)]; !left.empty();) {
        const auto* const place = std::find_if(std::begin(places), std::end(places), [&](const auto& each) {
            return left.substr(0, each.first.size()) == each.first;
        });
        const bool found = place != std::end(places);
        message += found ? place->second : std::string(1, left.front());
        left.remove_prefix(found ? place->first.size() : 1);
    }
    throw JobDied(kind_.code, cause, message);
}

void Job::no_worker(const std::string& did) const {
    throw Error(kind_.code,
                program + ": " + did + " as " + worker_name() + "; name the program `clarity` in CLARITY_WORKER or unset it");
}

void Job::unusable_result(const std::string& why) const {
    throw Error(kind_.code,
                (what_.empty() ? "" : what_ + ": ") + "the " + kind_.name + " worker's result cannot be used: " + why);
}

}  // namespace clarity::worker
