#include "check/check.hpp"

#include <unistd.h>

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
#include "base/printable.hpp"
#include "check/oclgrind.hpp"
#include "import/wire.hpp"
#include "worker/child.hpp"
#include "worker/supervisor.hpp"

namespace clarity::check {
namespace {

constexpr uint64_t kMemoryBytes = uint64_t(4) << 30;  // of a worker; the scenes are small
constexpr const char* kWorker = "check-worker";
// After so many deaths of its worker a phase ends: each endless loop costs its time limit.
constexpr unsigned kMostDeaths = 3;
// oclgrind takes seconds to minutes for the same rays, as the kernels are: it is cut after this processor time.
constexpr double kAccesses_s = 60;
constexpr const char* kAccessesCut = "cut after 60 s";

// The worker died in a check.
struct Died {
    std::string how;
    bool endless;
};

// The checks were told to stop.
struct Stopped {
    std::string why;
};

// Follows one worker through checks of one phase.
class CheckSupervisor : public worker::Supervisor {
 public:
    // stop: asked often; says why the worker must stop, or nothing.
    CheckSupervisor(worker::WorkerProcess& process, const std::string& plugin, Progress& progress,
                    const std::function<std::string()>& stop, const std::function<void(CheckResult)>& on_result)
        : Supervisor(process, {worker::kCheckGreeting, "a check worker", worker::worker_program(), Exit::failed}, progress),
          plugin_(plugin),
          stop_(stop),
          on_result_(on_result) {}
    // The check that runs, as far as it is known.
    CheckResult current() const {
        CheckResult result;
        result.plugin = plugin_;
        result.name = name_;
        result.tried = tried_;
        result.seconds = seconds_since(begin_);
        return result;
    }
    const std::string& step() const { return step_; }

 private:
    void handle(const worker::Message& message) override {
        if (message.kind == worker::MessageKind::running) {
            const size_t a = message.text.find('\n'), b = message.text.find('\n', a + 1);
            if (a == std::string::npos || b == std::string::npos) return;
            if (name_ != message.text.substr(0, a)) begin_ = std::chrono::steady_clock::now();
            name_ = message.text.substr(0, a);
            tried_ = message.text.substr(a + 1, b - a - 1);
            step_ = message.text.substr(b + 1);
            limit_s_ = message.fraction > 0 && message.fraction < 1000 ? double(message.fraction) : 10;
            made_progress();
        } else if (message.kind == worker::MessageKind::report) {
            const nlohmann::json json = nlohmann::json::parse(message.text, nullptr, false);
            if (!json.is_object()) return;
            CheckResult result;
            result.plugin = plugin_;
            result.name = json.value("name", "");
            result.tried = json.value("tried", "");
            const std::string kind = json.value("kind", "failed");
            result.outcome.kind = kind == "passed"    ? Outcome::Kind::passed
                                  : kind == "skipped" ? Outcome::Kind::skipped
                                                      : Outcome::Kind::failed;
            result.outcome.found = json.value("found", "");
            result.outcome.repeat = json.value("repeat", "");
            result.seconds = json.value("seconds", 0.0);
            made_progress();
            on_result_(result);
        }
    }
    void watched() override {
        if (std::string why = stop_(); !why.empty()) throw Stopped{std::move(why)};
    }
    double idle_limit_s() const override { return limit_s_; }
    bool counts_processor_time() const override { return true; }
    uint64_t processor_limit_s() const override { return 0; }
    uint64_t memory_limit_bytes() const override { return kMemoryBytes; }
    std::string speaker() const override { return plugin_; }
    void printed(const std::string& line) override {
        // The OpenCL compiler counts its warnings about our own kernels.
        if (line.find("warnings generated.") == std::string::npos && line.find("warning generated.") == std::string::npos)
            log(LogLevel::info, plugin_ + " printed: " + printable_line(line));
    }
    void ended(const worker::Ending& ending) const override {
        using End = worker::Ending::Kind;
        const std::string during = " while " + step_;
        switch (ending.kind) {
            case End::crashed:
                throw Died{"crashed (" + ending.how + ")" + during, false};
            case End::exited:
                throw Died{"ended the process (" + ending.how + ")" + during + ": a plugin must return instead", false};
            case End::no_progress:
                throw Died{"did not come to an end within " + ending.how + during + ": a loop without end", true};
            case End::memory:
                throw Died{"took more than " + ending.how + " of memory" + during, false};
            default:
                throw Died{"was killed" + during, false};
        }
    }

    const std::string plugin_;
    const std::function<std::string()>& stop_;
    const std::function<void(CheckResult)>& on_result_;
    std::string name_, tried_, step_ = "the library was loaded";
    double limit_s_ = 60;
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
        const Launch launch =
            in_oclgrind({worker::worker_program() == worker::kThisProgram ? program_file().string() : worker::worker_program(),
                         kWorker,
                         {}},
                        log);
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
    bool phase(const std::string& name, const Launch& launch = {worker::worker_program(), kWorker, {}},
               const std::string& log = {}) {
        std::vector<std::string> done;
        bool passed = true;
        const auto finish = [&](const CheckResult& result) {
            done.push_back(result.name);
            if (result.outcome.kind == Outcome::Kind::failed) passed = false;
            take(result);
        };
        for (unsigned deaths = 0;;) {
            if (!stop().empty()) return passed;
            std::vector<std::string> arguments = {"--library", record_.path,
                                                  "--phase",   name,
                                                  "--quick",   options_.quick ? "1" : "0",
                                                  "--list",    options_.list ? "1" : "0",
                                                  "--stop",    options_.stop_at_first ? "1" : "0",
                                                  "--seed",    std::to_string(options_.seed),
                                                  "--parent",  std::to_string(getpid())};
            for (const std::string& other : beside_) arguments.insert(arguments.end(), {"--beside", other});
            for (const std::string& sample : options_.samples) arguments.insert(arguments.end(), {"--sample", sample});
            if (!options_.truth_folder.empty()) arguments.insert(arguments.end(), {"--truth", options_.truth_folder});
            if (name == "imports" || name == "keys") arguments.insert(arguments.end(), {"--scratch", folder()});
            if (options_.large) arguments.insert(arguments.end(), {"--large", "1"});
            if (!options_.device.empty()) arguments.insert(arguments.end(), {"--device", options_.device});
            if (!options_.report_folder.empty()) arguments.insert(arguments.end(), {"--report", options_.report_folder});
            for (const int lanes : options_.lanes) arguments.insert(arguments.end(), {"--lanes", std::to_string(lanes)});
            for (const std::string& only : options_.only) arguments.insert(arguments.end(), {"--only", only});
            for (const std::string& other : done) arguments.insert(arguments.end(), {"--done", other});
            arguments.insert(arguments.begin(), launch.before.begin(), launch.before.end());
            const bool takes_scene = options_.scene && name == "hits";
            if (takes_scene) arguments.insert(arguments.end(), {"--rays", options_.rays_file});
            worker::WorkerProcess process(launch.program, launch.command, arguments, Exit::failed);
            if (takes_scene) import::write_scene(process.result(), *options_.scene);
            const std::function<void(CheckResult)> on_result = [&](CheckResult result) {
                if (!log.empty()) result.outcome = with_findings(result.outcome, log);
                finish(result);
            };
            const auto begin = std::chrono::steady_clock::now();
            const std::function<std::string()> stop_worker = [&] {
                std::string why = stop();
                // On a busy machine its processor time grows slowly: then it has three times as long.
                if (why.empty() && !log.empty() &&
                    (process.processor_s() > kAccesses_s || seconds_since(begin) > 3 * kAccesses_s))
                    why = kAccessesCut;
                return why;
            };
            CheckSupervisor supervisor(process, record_.plugin->id, progress_, stop_worker, on_result);
            try {
                supervisor.follow();
                return passed;
            } catch (const Stopped& stopped) {
                CheckResult result = supervisor.current();
                if (result.name.empty() || std::count(done.begin(), done.end(), result.name)) return passed;
                const std::string during = stopped.why + ", while " + supervisor.step();
                result.outcome = stopped.why == kAccessesCut
                                     ? with_findings(Outcome::passed("no access outside of a buffer so far; " + during), log)
                                     : Outcome::skipped("cut by " + during);
                finish(result);
                return passed;
            } catch (const Died& died) {
                CheckResult result = supervisor.current();
                if (result.name.empty()) result.name = name + ".start";
                result.outcome = Outcome::failed(died.how);
                finish(result);
                if (died.endless || ++deaths >= kMostDeaths || result.name == "builds.sound" || result.name == name + ".start")
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

bool is_wanted(const std::string& check, const std::vector<std::string>& only) {
    return only.empty() || std::any_of(only.begin(), only.end(),
                                       [&](const std::string& begin) { return check.compare(0, begin.size(), begin) == 0; });
}

CheckEnd check_plugin_library(const PluginRecord& record, const std::vector<std::string>& beside, const CheckOptions& options,
                              Progress& progress, const std::function<void(const CheckResult&)>& on_result) {
    if (std::getenv(worker::kWorkerVariable))
        throw Error(Exit::failed,
                    "this process is a worker itself and starts no other; set CLARITY_WORKER to the program `clarity`");
    return Run(record, beside, options, progress, on_result).all();
}

}  // namespace clarity::check
