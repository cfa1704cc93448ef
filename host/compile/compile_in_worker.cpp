#include "compile/compile_in_worker.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdlib>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/memory_text.hpp"
#include "base/physical_memory.hpp"
#include "base/printable.hpp"
#include "device/pocl_cache.hpp"
#include "worker/child.hpp"
#include "worker/supervisor.hpp"

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

class CompileSupervisor : public worker::Supervisor {
 public:
    CompileSupervisor(worker::WorkerProcess& process, const DeviceInfo& info, const std::string& what, Progress& progress)
        : Supervisor(process,
                     {worker::kCompileGreeting, "a compile worker", worker::worker_program(), Exit::kernel_build_failed},
                     progress),
          info_(info),
          what_(what),
          progress_(progress) {}

 private:
    // A compilation takes as long as it takes: the user decides.
    double idle_limit_s() const override { return 1e9; }
    uint64_t processor_limit_s() const override { return 0; }
    uint64_t memory_limit_bytes() const override { return most_compiler_bytes(); }
    std::string speaker() const override { return "the compiler of " + info_.name; }
    void handle(const worker::Message& message) override {
        if (message.kind == worker::MessageKind::running) step_ = message.text;
    }
    void printed(const std::string& line) override {
        Supervisor::printed(line);
        log_ += printable_line(line) + "\n";
    }
    void watched() override {
        const double seconds = seconds_since(begin_);
        if (seconds < next_word_s_) return;
        next_word_s_ += compile_patience_s();
        const std::string text = "the OpenCL compiler has been at work for " + std::to_string(std::lround(seconds)) +
                                 " s, with " + memory_limit_text(worker_.resident_bytes()) + " of memory (" + subject() + ")";
        log(LogLevel::warning, text + "; cancel it if you do not want to wait: " + kSimplerForms);
        progress_.stage(text);
    }
    void ended(const worker::Ending& ending) const override {
        using End = worker::Ending::Kind;
        const auto fail = [&](const std::string& why) {
            throw Error(Exit::kernel_build_failed, why + " (" + subject() + ")" + "; " + kSimplerForms, log_);
        };
        switch (ending.kind) {
            case End::crashed:
                fail("the OpenCL compiler crashed: " + ending.how +
                     (info_.pocl && !has_own_pocl_cache()
                          ? "; if it always does, the cache " + pocl_cache() + " may be damaged: delete that folder"
                          : ""));
                break;
            case End::exited:
                fail("the OpenCL compiler ended its process: " + ending.how);
                break;
            case End::memory:
                fail("the OpenCL compiler needs more than " + ending.how + " of memory, and was stopped");
                break;
            default:
                fail("the OpenCL compiler was killed from outside, maybe for want of memory");
        }
    }
    std::string subject() const {
        return (step_ == "launching" ? "generating code for " : "compiling ") + what_ + " for " + info_.name;
    }

    const DeviceInfo& info_;
    const std::string what_;
    Progress& progress_;
    const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double next_word_s_ = compile_patience_s();
    std::string step_, log_;
};

}  // namespace

double compile_patience_s() {
    const char* text = std::getenv("CLARITY_COMPILE_PATIENCE");
    const double seconds = text ? std::strtod(text, nullptr) : 0;
    return seconds > 0 && std::isfinite(seconds) ? seconds : 60;
}

CompileOutcome compile_in_worker(const DeviceInfo& info, const CompileJob& job, const std::string& what, Progress& progress) {
    if (progress.cancelled()) throw Cancelled();
    worker::WorkerProcess process(worker::worker_program(), "compile-worker", {"--parent", std::to_string(getpid())},
                                  Exit::kernel_build_failed);
    std::string why = write_compile_job(process.result().fd(), job);
    if (!why.empty()) throw Error(Exit::kernel_build_failed, why);
    worker::send_message(process.channel(), {worker::MessageKind::proceed, 0, 0, {}});
    CompileSupervisor(process, info, what, progress).follow();
    process.kill_now();
    process.wait();
    CompileOutcome outcome;
    why = read_compile_outcome(process.result().fd(), outcome);
    if (!why.empty()) throw Error(Exit::kernel_build_failed, why);
    return outcome;
}

}  // namespace clarity
