#include "tools/check/check.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include <nlohmann/json.hpp>

#include "base/elapsed.hpp"
#include "base/files/library_files.hpp"
#include "base/files/temporary_folder.hpp"
#include "base/log.hpp"
#include "rt_surface.h"
#include "tools/check/oclgrind.hpp"
#include "worker/child.hpp"
#include "worker/job.hpp"

namespace clarity::check {
namespace {

constexpr uint64_t kMemoryBytes = uint64_t(4) << 30;  // of a worker; the scenes are small
// After so many deaths of its worker a phase ends: each endless loop costs its time limit.
constexpr unsigned kMostDeaths = 3;

// Of what a worker says, which is not trusted.
Asked asked_in(int number) {
    return static_cast<Asked>(std::clamp(number, 0, static_cast<int>(Asked::any_lanes)));
}

// The checks were told to stop.
struct Stopped {
    std::string why;
};

// One worker that runs checks of one phase.
class CheckRun : public worker::Job {
 public:
    // stop: asked often; says why the worker must stop, or nothing.
    CheckRun(const std::string& plugin, const std::function<std::string(const worker::WorkerProcess&)>& stop,
             const std::function<void(CheckResult)>& on_result)
        : Job(kCheckJob, plugin, {10, 0, kMemoryBytes}), stop_(stop), on_result_(on_result) {
        current_.plugin = plugin;
    }
    // The check that runs, as far as it is known.
    CheckResult current() const {
        CheckResult result = current_;
        result.seconds = seconds_since(begin_);
        return result;
    }
    const std::string& step() const { return step_; }

 private:
    void on_step(const std::string& text) override {
        const size_t a = text.find('\n'), b = text.find('\n', a + 1), c = text.find('\n', b + 1);
        if (a == std::string::npos || b == std::string::npos || c == std::string::npos) return;
        if (current_.name != text.substr(0, a)) begin_ = std::chrono::steady_clock::now();
        current_.name = text.substr(0, a);
        current_.tried = text.substr(a + 1, b - a - 1);
        current_.outcome.asked = asked_in(std::atoi(text.c_str() + b + 1));
        step_ = text.substr(c + 1);
    }
    void on_report(const std::string& text) override {
        const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
        if (!json.is_object()) return;
        CheckResult result;
        result.plugin = who_;
        result.name = json.value("name", "");
        result.tried = json.value("tried", "");
        const std::string kind = json.value("kind", "failed");
        result.outcome.kind = kind == "passed"    ? Outcome::Kind::passed
                              : kind == "skipped" ? Outcome::Kind::skipped
                                                  : Outcome::Kind::failed;
        result.outcome.found = json.value("found", "");
        result.outcome.repeat = json.value("repeat", "");
        result.outcome.asked = asked_in(json.value("asked", 0));
        result.seconds = json.value("seconds", 0.0);
        on_result_(result);
    }
    void watch() override {
        if (std::string why = stop_(process()); !why.empty()) throw Stopped{std::move(why)};
    }
    void on_output(const std::string& line) override {
        // The OpenCL compiler counts its warnings about our own kernels.
        if (line.find("warnings generated.") == std::string::npos && line.find("warning generated.") == std::string::npos)
            Job::on_output(line);
    }

    const std::function<std::string(const worker::WorkerProcess&)>& stop_;
    const std::function<void(CheckResult)>& on_result_;
    CheckResult current_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// All checks of one library. Phases run side by side, each in workers of its own.
class Run {
 public:
    Run(const PluginRecord& record, const std::vector<std::string>& beside, const CheckOptions& options, Progress& progress,
        const std::function<void(const CheckResult&)>& on_result)
        : record_(record), beside_(beside), options_(options), progress_(progress), on_result_(on_result) {}

    CheckEnd all() {
        if (record_.plugin->importer) {
            phase("imports");
        } else if (record_.plugin->primitive) {
            // Kernels of a shape whose host part fails say nothing.
            if (phase("keys")) kernels("shape");
        } else if (rt_surface_of(record_.plugin)) {
            phase("surface");
        } else {
            structure();
        }
        if (count_ == 0 && cut_.empty())
            throw Error(Exit::usage, "--only " + options_.only.front() + ": " + record_.plugin->id +
                                         " has no check whose name begins like this; `clarity check " + record_.plugin->id +
                                         " --list` lists them");
        if (options_.stop_at_first && failed_) stop();  // the worker may have stopped by itself
        return {failed_, cut_};
    }

 private:
    // Builds and hits side by side.
    void structure() {
        std::exception_ptr thrown;
        std::thread builds([&] {
            try {
                phase("builds");
            } catch (...) {
                thrown = std::current_exception();
            }
            tell_sound();
        });
        std::exception_ptr thrown_here;
        try {
            if (wait_until_sound()) kernels("hits");
        } catch (...) {
            thrown_here = std::current_exception();
        }
        builds.join();
        if (thrown) std::rethrow_exception(thrown);
        if (thrown_here) std::rethrow_exception(thrown_here);
    }
    // oclgrind is slow and may be missing, so only the long form asks for it.
    void kernels(const std::string& name) {
        if (!phase(name) || options_.quick || !is_wanted(kAccessCheck, options_.only)) return;
        CheckResult result;
        result.plugin = record_.plugin->id;
        result.name = kAccessCheck;
        result.tried = kAccessTried;
        if (options_.list) {
            result.outcome = Outcome::skipped("");
            return take(result);
        }
        const std::string log = folder() + "/oclgrind.log";
        const std::string program = worker::worker_program();
        const Launch launch = in_oclgrind(program == worker::kThisProgram ? program_file().string() : program, log);
        if (!launch.program.empty()) {
            phase("accesses", launch, log);
            return;
        }
        result.outcome = Outcome::skipped("oclgrind is not installed");
        take(result);
    }
    // Hits of a builder that fails say nothing: wait for builds.sound.
    bool wait_until_sound() {
        std::unique_lock<std::mutex> lock(mutex_);
        sound_known_.wait(lock, [&] { return sound_is_known_; });
        return !unsound_;
    }
    void tell_sound() {
        const std::lock_guard<std::mutex> lock(mutex_);
        sound_is_known_ = true;
        sound_known_.notify_all();
    }

    // Where damaged files and logs are written: the folder of the report, or one that goes with this object.
    const std::string& folder() {
        if (!options_.report_folder.empty()) return options_.report_folder;
        if (!temporary_) temporary_.emplace("clarity-check");
        return temporary_->path();
    }

    // Why no check may go on; empty: nothing stands against it.
    std::string stop() {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (cut_.empty() && options_.stop_at_first && failed_) cut_ = "--stop-at-first: a check has failed";
        if (cut_.empty() && options_.time_limit_s > 0 && seconds_since(begin_) > options_.time_limit_s)
            cut_ = "--time-limit: " + worker::in_words(options_.time_limit_s) + " are over";
        return cut_;
    }

    void take(const CheckResult& result) {
        const std::lock_guard<std::mutex> lock(mutex_);
        ++count_;
        if (result.outcome.kind == Outcome::Kind::failed) failed_ = true;
        if (result.name == "builds.sound") {
            unsound_ = result.outcome.kind == Outcome::Kind::failed;
            sound_is_known_ = true;
            sound_known_.notify_all();
        }
        on_result_(result);
    }

    // Runs the checks of one phase, each until its end or its worker's death. log: of oclgrind; empty: the worker runs by
    // itself. Returns whether none failed.
    bool phase(const std::string& name, const Launch& launch = {worker::worker_program(), {}}, const std::string& log = {}) {
        CheckJob job;
        job.library = record_.path, job.phase = name, job.device = options_.device, job.report = options_.report_folder;
        job.truth = options_.truth_folder, job.beside = beside_, job.samples = options_.samples, job.only = options_.only;
        job.lanes = options_.lanes, job.quick = options_.quick, job.large = options_.large, job.list = options_.list;
        job.stop_at_first = options_.stop_at_first, job.seed = options_.seed, job.closed = options_.closed;
        if (name == "imports" || name == "keys") job.scratch = folder();
        if (options_.scene && name == "hits") {
            job.rays = options_.rays_file;
            job.scene.push_back({*options_.scene});
        }
        bool passed = true;
        const auto finish = [&](const CheckResult& result) {
            job.done.insert(result.name);
            if (result.outcome.kind == Outcome::Kind::failed) passed = false;
            take(result);
        };
        for (unsigned deaths = 0;;) {
            if (!stop().empty()) return passed;
            const std::function<void(CheckResult)> on_result = [&](CheckResult result) {
                if (!log.empty()) result.outcome = with_findings(result.outcome, log);
                finish(result);
            };
            const auto begin = std::chrono::steady_clock::now();
            const std::string accesses_cut = "cut after " + worker::in_words(options_.oclgrind_time_s);
            const std::function<std::string(const worker::WorkerProcess&)> stop_worker =
                [&](const worker::WorkerProcess& process) {
                    std::string why = stop();
                    // On a busy machine its processor time grows slowly: then it has three times as long.
                    if (why.empty() && !log.empty() &&
                        (process.processor_s() > options_.oclgrind_time_s ||
                         seconds_since(begin) > 3 * options_.oclgrind_time_s))
                        why = accesses_cut;
                    return why;
                };
            CheckRun run(record_.plugin->id, stop_worker, on_result);
            run.program = launch.program, run.words_before = launch.words, run.subject = record_.path;
            try {
                run.run(job, progress_);
                return passed;
            } catch (const Stopped& stopped) {
                CheckResult result = run.current();
                // A worker that was cut before it named a check has still tried to begin one.
                const bool begun = !result.name.empty();
                if (!begun && !log.empty()) {
                    result.plugin = record_.plugin->id;
                    result.name = kAccessCheck;
                    result.tried = kAccessTried;
                }
                if (result.name.empty() || job.done.count(result.name)) return passed;
                const std::string during = stopped.why + ", while " + (begun ? run.step() : "the simulated device was made");
                result.outcome = begun && stopped.why == accesses_cut
                                     ? with_findings(Outcome::passed("no access outside of a buffer so far; " + during), log)
                                     : Outcome::skipped((stopped.why == accesses_cut ? "" : "cut by ") + during);
                finish(result);
                return passed;
            } catch (const worker::JobDied& died) {
                CheckResult result = run.current();
                if (result.name.empty()) result.name = name + ".start";
                const Asked asked = result.outcome.asked;
                result.outcome = Outcome::failed(died.what());
                result.outcome.asked = asked;
                finish(result);
                if (died.cause == worker::Cause::no_progress || ++deaths >= kMostDeaths || result.name == "builds.sound" ||
                    result.name == name + ".start")
                    return passed;
            }
        }
    }

    const PluginRecord& record_;
    const std::vector<std::string>& beside_;
    const CheckOptions& options_;
    std::optional<TemporaryFolder> temporary_;
    Progress& progress_;
    const std::function<void(const CheckResult&)>& on_result_;
    std::mutex mutex_;
    std::condition_variable sound_known_;
    bool sound_is_known_ = false, unsound_ = false, failed_ = false;
    std::string cut_;
    const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    size_t count_ = 0;
};

}  // namespace

const worker::JobKind kCheckJob = {
    "check",
    "to check a plugin, run `clarity check PLUGIN`",
    Exit::failed,
    true,
    LogLevel::info,
    {"crashed ({how}) while {step}", "ended the process ({how}) while {step}: a plugin must return instead",
     "did not come to an end within {how} while {step}: a loop without end", "was killed while {step}",
     "took more than {how} of memory while {step}", "was killed while {step}"},
    check_job};

bool is_wanted(const std::string& check, const std::vector<std::string>& only) {
    return only.empty() || std::any_of(only.begin(), only.end(),
                                       [&](const std::string& begin) { return check.compare(0, begin.size(), begin) == 0; });
}

CheckEnd check_plugin_library(const PluginRecord& record, const std::vector<std::string>& beside, const CheckOptions& options,
                              Progress& progress, const std::function<void(const CheckResult&)>& on_result) {
    if (worker::in_worker())
        throw Error(Exit::failed,
                    "this process is a worker itself and starts no other; set CLARITY_WORKER to the program `clarity`");
    return Run(record, beside, options, progress, on_result).all();
}

}  // namespace clarity::check
