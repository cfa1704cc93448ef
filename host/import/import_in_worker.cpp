#include "import/import_in_worker.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/lower.hpp"
#include "base/memory_text.hpp"
#include "import/wire.hpp"
#include "import/worker_channel.hpp"
#include "import/worker_process.hpp"

namespace clarity::import {
namespace {

constexpr double kPollSeconds = 0.02;
constexpr double kGreetingSeconds = 5;  // our worker sends its greeting within milliseconds, also on a loaded machine
constexpr double kCancelGraceSeconds = 0.05;
constexpr size_t kMaxOutputLines = 200;

// Limits of a worker. They grow with the sizes of all files that it reads, included files too.
class Limits {
 public:
    explicit Limits(const ImportOptions& options) : options_(options) {}
    void add_file(const std::string& path) {
        std::error_code error;
        const uint64_t size = std::filesystem::file_size(path, error);
        if (!error) file_bytes_ += std::min(size, uint64_t(1) << 50);
    }
    // Seconds without progress. Small files are read in milliseconds; a damaged file that puts a parser into an endless loop
    // must be stopped within ten seconds.
    double idle_s() const { return std::min(7 + 2 * static_cast<double>(file_bytes_) / (1 << 20), options_.time_limit_s); }
    uint64_t cpu_s() const { return static_cast<uint64_t>(std::ceil(std::clamp(options_.time_limit_s, 1.0, 1e9))); }
    uint64_t memory_bytes() const {
        if (options_.memory_limit_bytes > 0) return options_.memory_limit_bytes;
        return std::min(std::max(uint64_t(1) << 30, 64 * file_bytes_), most_memory_bytes());
    }
    uint64_t most_memory_bytes() const {
        if (options_.memory_limit_bytes > 0) return options_.memory_limit_bytes;
        return static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) / 4 * 3;
    }

 private:
    const ImportOptions& options_;
    uint64_t file_bytes_ = 0;
};

std::string worker_program(const ImportOptions& options) {
    if (!options.worker.empty()) return options.worker;
    const char* named = std::getenv("CLARITY_WORKER");
    return named && *named ? named : "/proc/self/exe";
}

std::string in_words(double seconds) {
    const auto tenths = static_cast<uint64_t>(std::lround(seconds * 10));
    return std::to_string(tenths / 10) + (tenths % 10 != 0 ? "." + std::to_string(tenths % 10) : "") + " s";
}

// Supervises one import: follows the worker until it is done or dead.
class Supervisor {
 public:
    Supervisor(WorkerProcess& worker, Limits limits, std::string first_file, std::string program, Progress& progress)
        : worker_(worker), limits_(limits), program_(std::move(program)), progress_(progress), file_(std::move(first_file)) {}

    // Returns once the result is in shared memory. Throws Error(import_failed) or Cancelled.
    void follow() {
        while (!done_) {
            std::array<pollfd, 2> ready = {pollfd{worker_.channel(), POLLIN, 0}, pollfd{worker_.output(), POLLIN, 0}};
            const int wait_ms = static_cast<int>(1000 * kPollSeconds);
            poll(ready.data(), output_open_ ? 2 : 1, wait_ms);
            forward_output();
            const bool alive = read_messages();
            if (progress_.cancelled()) stop_on_cancel();
            if (!alive && !done_) explain_death(worker_.wait());
            if (!done_) watch();
        }
    }

 private:
    [[noreturn]] void fail(const std::string& why) const { throw Error(Exit::import_failed, file_ + ": " + why); }
    std::string importer() const { return importer_.empty() ? "the importer" : "the importer " + importer_; }

    // Returns false once the worker has closed its end, which happens when it dies.
    bool read_messages() {
        Message message;
        // Read a limited number, so that a flood of messages cannot keep us from checking the time.
        for (int i = 0; i < 1000 && !done_; ++i) {
            switch (receive_message(worker_.channel(), message)) {
                case Received::nothing:
                    return true;
                case Received::closed:
                    return false;
                case Received::message:
                    handle(message);
            }
        }
        return true;
    }

    void handle(const Message& message) {
        if (!greeted_) {
            if (message.kind != MessageKind::greeting || message.text != kWorkerGreeting) {
                throw Error(Exit::import_failed, program_ +
                                                     ": is no import worker of this version of clarity; name the right program "
                                                     "in CLARITY_WORKER or unset it");
            }
            greeted_ = true;
        }
        switch (message.kind) {
            case MessageKind::running: {
                const size_t end = message.text.find('\n');
                file_ = message.text.substr(0, end);
                importer_ = end == std::string::npos ? "" : message.text.substr(end + 1);
                idle_s_ = 0;
                const uint64_t before = limits_.memory_bytes();
                limits_.add_file(file_);
                worker_.raise_memory_limit(limits_.memory_bytes() - before);
                send_message(worker_.channel(), {MessageKind::proceed, 0, 0, {}});
                break;
            }
            case MessageKind::stage:
                progress_.stage(message.text);
                fraction_ = -1;
                idle_s_ = 0;
                break;
            case MessageKind::progress:
                // A report counts as progress only if the fraction has grown.
                if (std::isfinite(message.fraction) && message.fraction > fraction_ + 0.001f) {
                    fraction_ = message.fraction;
                    idle_s_ = 0;
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
                throw Error(Exit::import_failed, message.text);
            case MessageKind::done:
                done_ = true;
                break;
            default:
                break;
        }
    }

    // Logs what libraries print, at level debug.
    void forward_output() {
        std::array<char, 4096> buffer;
        for (ssize_t bytes = 0; output_open_ && (bytes = read(worker_.output(), buffer.data(), buffer.size())) != -1;) {
            if (bytes == 0) output_open_ = false;
            line_.append(buffer.data(), static_cast<size_t>(bytes));
            for (size_t end = line_.find('\n'); end != std::string::npos || line_.size() > 1000; end = line_.find('\n')) {
                const std::string text = line_.substr(0, std::min(end, size_t(1000)));
                line_.erase(0, end == std::string::npos ? text.size() : end + 1);
                if (++output_lines_ <= kMaxOutputLines) log(LogLevel::debug, importer() + " printed: " + text);
            }
            if (output_lines_ > kMaxOutputLines) break;  // read once per round only, so that a flood cannot hold us up
        }
    }

    [[noreturn]] void stop_on_cancel() {
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

    void watch() {
        // Time in which this process itself did not run (suspended, stopped in a terminal) does not count against the worker.
        const auto now = std::chrono::steady_clock::now();
        const double passed_s = std::min(std::chrono::duration<double>(now - last_look_).count(), 0.5);
        last_look_ = now;
        idle_s_ += passed_s;
        if (!greeted_ && idle_s_ > kGreetingSeconds) {
            throw Error(Exit::import_failed, program_ +
                                                 ": does not answer as an import worker; name the program `clarity` in "
                                                 "CLARITY_WORKER or unset it");
        }
        if (idle_s_ > limits_.idle_s()) {
            fail(importer() + " made no progress for " + in_words(limits_.idle_s()) +
                 " and was stopped; the file is damaged, or too complex for the library that reads it");
        }
        // The worker's address space is limited already. Its resident memory is checked as well, as a second safeguard.
        memory_look_s_ += passed_s;
        if (memory_look_s_ < 0.1) return;
        memory_look_s_ = 0;
        if (worker_.resident_bytes() > limits_.memory_bytes() + (uint64_t(256) << 20)) out_of_memory();
    }

    [[noreturn]] void out_of_memory() const {
        fail(importer() + " needs more than " + memory_limit_text(limits_.memory_bytes()) +
             " of memory; the file is damaged, or larger than this machine can import");
    }

    [[noreturn]] void explain_death(int status) const {
        if (!greeted_) {
            throw Error(Exit::import_failed, program_ +
                                                 ": ended without answering as an import worker; name the program "
                                                 "`clarity` in CLARITY_WORKER or unset it");
        }
        const std::string advice = "; the file is damaged or uses something that the library cannot handle";
        if (last_words_ == "out of memory") out_of_memory();
        if (WIFEXITED(status)) {
            fail(importer() + " ended the worker process (exit code " + std::to_string(WEXITSTATUS(status)) +
                 ") without a result" + advice);
        }
        const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        if (signal == SIGXCPU) {
            fail(importer() + " used more than " + in_words(static_cast<double>(limits_.cpu_s())) +
                 " of processor time and was stopped" + advice);
        }
        if (signal == SIGKILL) {
            fail(importer() +
                 "'s worker process was killed from outside, as the system does when memory runs out; close other "
                 "programs or take a smaller file");
        }
        const char* name = strsignal(signal);
        std::string how = name ? name : "signal " + std::to_string(signal);
        how.front() = lower(how.front());
        if (!last_words_.empty()) how += ": " + last_words_;
        fail(importer() + " crashed (" + how + ") while reading" + advice);
    }

    WorkerProcess& worker_;
    Limits limits_;
    const std::string program_;
    Progress& progress_;
    std::string file_, importer_, last_words_, line_;
    std::chrono::steady_clock::time_point last_look_ = std::chrono::steady_clock::now();
    double idle_s_ = 0, memory_look_s_ = 0;
    float fraction_ = -1;
    size_t output_lines_ = 0;
    bool greeted_ = false, output_open_ = true, done_ = false;
};

}  // namespace

Scene import_in_worker(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                       Progress& progress) {
    if (std::getenv(kWorkerVariable)) {
        throw Error(Exit::import_failed, files.front() +
                                             ": this process is an import worker itself and starts no other; set "
                                             "CLARITY_WORKER to the program `clarity`");
    }
    const Limits limits(options);
    const std::string program = worker_program(options);
    std::vector<std::string> arguments;
    const std::pair<const char*, uint64_t> numbers[] = {{"--memory", limits.memory_bytes()},
                                                        {"--most-memory", limits.most_memory_bytes()},
                                                        {"--cpu", limits.cpu_s()},
                                                        {"--parent", static_cast<uint64_t>(getpid())}};
    for (const auto& [key, value] : numbers) arguments.insert(arguments.end(), {key, std::to_string(value)});
    for (const PluginRecord& record : plugins.records()) {
        if (!record.plugin || record.shadowed || !record.plugin->importer) continue;
        arguments.insert(arguments.end(), {"--plugin", record.path});
    }
    for (const std::string& folder : options.search_paths) arguments.insert(arguments.end(), {"--search", folder});
    arguments.push_back("--");
    arguments.insert(arguments.end(), files.begin(), files.end());

    WorkerProcess worker(program, arguments);
    Supervisor supervisor(worker, limits, files.front(), program, progress);
    supervisor.follow();
    Scene scene;
    const std::string why = read_scene(worker.result(), scene);
    if (!why.empty()) throw Error(Exit::import_failed, files.front() + ": the import worker's result cannot be used: " + why);
    return scene;
}

}  // namespace clarity::import
