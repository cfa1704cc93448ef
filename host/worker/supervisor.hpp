// supervisor.hpp -- follows a worker process until it is done or dead, and holds it to its limits.
#pragma once
#include <chrono>
#include <string>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "worker/channel.hpp"
#include "worker/process.hpp"

namespace clarity::worker {

// How a worker ended without a result.
struct Ending {
    enum class Kind { crashed, exited, no_progress, processor_time, memory, killed } kind;
    // crashed: "segmentation fault: stack overflow"; exited: "exit code 3"; no_progress, processor_time: the limit, "7 s";
    // memory: the limit, "1 GiB".
    std::string how;
};

std::string in_words(double seconds);  // "1.5 s"

// Users of workers derive from it. For one thread.
class Supervisor {
 public:
    // What kind of worker it is, for messages.
    struct Kind {
        const char* greeting;  // the worker's first message
        const char* name;      // "an import worker"
        std::string program;
        Exit code;  // of errors
    };
    Supervisor(WorkerProcess& worker, Kind kind, Progress& progress)
        : worker_(worker), kind_(std::move(kind)), progress_(progress) {}
    virtual ~Supervisor() = default;
    // Returns once the worker says that it is done. Throws Error(code), Cancelled, and what ended() throws.
    void follow();

 protected:
    // Messages that only this kind of worker sends.
    virtual void handle(const Message&) {}
    virtual double idle_limit_s() const = 0;  // seconds without progress
    // Whether these are seconds of the worker's processor time, so that a busy machine accuses no one; a worker that only waits
    // then has kWaitFactor times as long.
    virtual bool counts_processor_time() const { return false; }
    virtual uint64_t processor_limit_s() const = 0;
    virtual uint64_t memory_limit_bytes() const = 0;  // of resident memory
    virtual std::string speaker() const = 0;          // who prints: "the importer obj"
    // Throws the error that tells the user. Must not return.
    virtual void ended(const Ending& ending) const = 0;
    // Called about fifty times a second while the worker runs.
    virtual void watched() {}
    // What the worker printed may be worth a louder line than debug.
    virtual void printed(const std::string& line);

    void made_progress();
    static constexpr double kWaitFactor = 12;
    WorkerProcess& worker_;

 private:
    bool read_messages();
    void take(const Message& message);
    void forward_output();
    void forward_last_output();
    [[noreturn]] void stop_on_cancel();
    void watch();
    void explain_death(int status) const;

    const Kind kind_;
    Progress& progress_;
    std::string last_words_, line_;
    std::chrono::steady_clock::time_point last_look_ = std::chrono::steady_clock::now();
    double idle_s_ = 0, memory_look_s_ = 0;
    double busy_from_s_ = 0;  // processor time of the worker when it last made progress
    float fraction_ = -1;
    size_t output_lines_ = 0;
    bool greeted_ = false, output_open_ = true, done_ = false;
};

}  // namespace clarity::worker
