#include "compile/compile_in_worker.hpp"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/machine.hpp"
#include "base/text.hpp"
#include "device/pocl_cache.hpp"

namespace clarity {
namespace {

constexpr const char* kSimplerForms = "fewer lanes (--lanes 1) or another structure (--accel bvh2) are simpler to compile";

// A compiler may take this much resident memory: CLARITY_COMPILE_MEMORY in MiB, or three quarters of the machine's.
uint64_t most_compiler_bytes() {
    const char* text = std::getenv("CLARITY_COMPILE_MEMORY");
    if (const uint64_t mebibytes = text ? std::strtoull(text, nullptr, 10) : 0; mebibytes > 0 && mebibytes < (1u << 30))
        return mebibytes << 20;
    return physical_memory_bytes() / 4 * 3;
}

// A compilation takes as long as it takes: the user decides.
class Compilation : public worker::Job {
 public:
    Compilation(const DeviceInfo& info, const std::string& what)
        : Job(kCompileJob, "the compiler of " + info.name, {1e9, 0, most_compiler_bytes()}) {
        what_ = what + " for " + info.name;
        step_ = "compiling";
        if (info.pocl && !has_own_pocl_cache())
            advice = "; if it always does, the cache " + pocl_cache() + " may be damaged: delete that folder";
    }
    CompileOutcome outcome(const CompileJob& job, Progress& progress) {
        try {
            CompileOutcome outcome;
            run(job, outcome, progress);
            return outcome;
        } catch (const worker::JobDied& died) {
            const std::string message = std::string(died.what()) + " (" + doing() + "); " + kSimplerForms;
            if (died.cause == worker::Cause::crashed || died.cause == worker::Cause::exited)
                throw CompilerCrashed(died.code(), message, log_);
            throw Error(died.code(), message, log_);
        }
    }

 private:
    void on_output(const std::string& line) override {
        Job::on_output(line);
        log_ += printable_line(line) + "\n";
    }
    void watch() override {
        const double seconds = seconds_since(begin_);
        if (seconds < next_word_s_) return;
        next_word_s_ += compile_patience_s();
        const std::string text = "the OpenCL compiler has been at work for " + std::to_string(std::lround(seconds)) +
                                 " s, with " + memory_limit_text(process().resident_bytes()) + " of memory (" + doing() + ")";
        log(LogLevel::warning, text + "; cancel it if you do not want to wait: " + kSimplerForms);
        progress().stage(text);
    }
    std::string doing() const { return step_ + " " + what_; }

    const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double next_word_s_ = compile_patience_s();
    std::string log_;
};

// An empty folder for PoCL in one worker: what it compiles there comes back as a binary. Gone at the end, however the worker
// ends.
class WorkerFolder {
 public:
    explicit WorkerFolder(const DeviceInfo& info) {
        static std::atomic<unsigned> count{0};
        if (info.pocl && has_own_pocl_cache()) path_ = pocl_cache() + "/worker-" + std::to_string(count++);
    }
    ~WorkerFolder() {
        std::error_code ignored;
        if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    }
    WorkerFolder(const WorkerFolder&) = delete;
    WorkerFolder& operator=(const WorkerFolder&) = delete;
    const std::string& path() const { return path_; }

 private:
    std::string path_;  // empty: PoCL has no folder of this process's own, and uses its usual one
};

constexpr const char* kKilled = "the OpenCL compiler was killed from outside, maybe for want of memory";

}  // namespace

const worker::JobKind kCompileJob = {
    "compile",
    "to compile kernels, run `clarity render`",
    Exit::kernel_build_failed,
    false,
    LogLevel::debug,
    {"the OpenCL compiler crashed: {how}{advice}", "the OpenCL compiler ended its process: {how}", kKilled, kKilled,
     "the OpenCL compiler needs more than {how} of memory, and was stopped", kKilled},
    compile_job};

double compile_patience_s() {
    const char* text = std::getenv("CLARITY_COMPILE_PATIENCE");
    const double seconds = text ? std::strtod(text, nullptr) : 0;
    return seconds > 0 && std::isfinite(seconds) ? seconds : 60;
}

CompileOutcome compile_in_worker(const DeviceInfo& info, const std::string& source, const std::string& options,
                                 const std::string& work_group_method, const std::string& what, Progress& progress) {
    if (progress.cancelled()) throw Cancelled();
    const WorkerFolder folder(info);
    return Compilation(info, what)
        .outcome({source, options, info.id(), info.name, info.driver, folder.path(), work_group_method}, progress);
}

}  // namespace clarity
