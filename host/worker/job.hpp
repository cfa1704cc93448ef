// job.hpp -- work in another process: job(kind, arguments) -> result. What all kinds have in common is here: the start, limits,
// progress, cancel, and the cause of death in words.
#pragma once
#include <array>
#include <chrono>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/parcel.hpp"
#include "base/log.hpp"
#include "base/progress.hpp"
#include "worker/channel.hpp"
#include "worker/process.hpp"

namespace clarity::worker {

// How a worker ended without a result. The order of JobKind::deaths.
enum class Cause { crashed, exited, no_progress, processor_time, memory, killed };

// A kind of work that is done in a worker: one row for each.
struct JobKind {
    const char* name;     // "import": the worker runs as `clarity import-worker`
    const char* instead;  // what a person should run, "to import a file, run `clarity info FILE`"
    Exit code;            // of errors
    // Whether the limit of time counts the worker's processor time, so that a busy machine accuses no one; a worker that only
    // waits then has kWaitFactor times as long.
    bool counts_processor_time;
    LogLevel output_level;  // of what libraries print
    // What the user is told, by Cause. {how} is what is known of it: crashed: "segmentation fault: stack overflow"; exited:
    // "exit code 3"; no_progress, processor_time and memory: the limit, "7 s", "1 GiB". {who}, {what}, {step} and {advice} are
    // members of Job.
    std::array<const char*, 6> deaths;
    void (*main)(ParcelReader& arguments);  // the work, in the worker: see child.hpp; nullptr: a tool has it, and fills it in
};

constexpr Failure failure_of(Cause cause) {
    constexpr Failure kFailures[] = {Failure::crash,   Failure::exit,      Failure::endless,
                                     Failure::endless, Failure::no_memory, Failure::other};
    static_assert(std::size(kFailures) == size_t(Cause::killed) + 1);
    return kFailures[static_cast<size_t>(cause)];
}

struct JobDied : Error {
    JobDied(Exit code, Cause of, const std::string& message) : Error(Error(code, message).as(failure_of(of))), cause(of) {}
    Cause cause;
};

struct JobLimits {
    double idle_s = 1e9;        // seconds without progress
    uint64_t processor_s = 0;   // of the whole work; the worker sets itself this limit, here it is for the message
    uint64_t memory_bytes = 0;  // of resident memory
};

std::string in_words(double seconds);  // "1.5 s"

// One run of a job, on the program's side. Kinds whose workers say more than their progress derive from it. For one thread, and
// for one run.
class Job {
 public:
    Job(const JobKind& kind, std::string who, JobLimits limits) : kind_(kind), who_(std::move(who)), limits_(limits) {}
    virtual ~Job() = default;
    // Both throw JobDied, Error(kind.code) and Cancelled.
    template <class Arguments>
    void run(const Arguments& arguments, Progress& progress) {
        MemoryFile file;
        ParcelWriter parcel(file);
        parcel(arguments);
        parcel.finish();
        file.seal();
        follow(file, progress);
    }
    // The same for a job with a result.
    template <class Arguments, class Result>
    void run(const Arguments& arguments, Result& result, Progress& progress) {
        run(arguments, progress);
        try {
            ParcelReader parcel(process_->result(), ParcelReader::How::emptied);
            parcel(result);
            parcel.end();
        } catch (const Error& e) {
            unusable_result(e.what());
        }
    }

    std::string advice;   // for messages
    std::string subject;  // what lists of processes show
    // How the worker is started: `program WORDS... import-worker ...`.
    std::string program = worker_program();
    std::vector<std::string> words_before;

 protected:
    // A step of the work begins. Its limit is in force already.
    virtual void on_step(const std::string& text) { step_ = text; }
    virtual void on_report(const std::string&) {}
    // A line that the worker or its libraries printed.
    virtual void on_output(const std::string& line);
    // Called about fifty times a second while the worker runs.
    virtual void watch() {}

    WorkerProcess& process() { return *process_; }
    const WorkerProcess& process() const { return *process_; }
    Progress& progress() { return *progress_; }

    const JobKind& kind_;
    std::string who_;   // who works, and prints: "the importer obj"
    std::string what_;  // on what
    std::string step_ = "starting";
    JobLimits limits_;

 private:
    static constexpr double kWaitFactor = 12;
    std::string worker_name() const;  // "an import worker"
    void follow(const MemoryFile& arguments, Progress& progress);
    bool read_messages();
    void take(const Message& message);
    void forward_output();
    void forward_last_output();
    void made_progress();
    [[noreturn]] void stop_on_cancel();
    void look_at_limits();
    [[noreturn]] void explain_death(int status) const;
    [[noreturn]] void died(Cause cause, const std::string& how) const;
    [[noreturn]] void no_worker(const std::string& did) const;
    [[noreturn]] void unusable_result(const std::string& why) const;

    std::optional<WorkerProcess> process_;
    Progress* progress_ = nullptr;
    std::string last_words_, line_;
    bool memory_refused_ = false;
    std::chrono::steady_clock::time_point last_look_{};
    double idle_s_ = 0, memory_look_s_ = 0;
    double busy_from_s_ = 0;  // processor time of the worker when it last made progress
    float fraction_ = -1;
    size_t output_lines_ = 0;
    bool greeted_ = false, output_open_ = true, done_ = false;
};

}  // namespace clarity::worker
