// child.hpp -- the worker's side: how a worker process begins, reports, and tells why it dies.
#pragma once
#include <chrono>
#include <mutex>
#include <string>

#include "base/progress.hpp"
#include "worker/channel.hpp"

namespace clarity::worker {

// First messages of our workers.
inline constexpr const char* kImportGreeting = "clarity import worker 1";
inline constexpr const char* kBuildGreeting = "clarity build worker 1";
inline constexpr const char* kCheckGreeting = "clarity check worker 1";
inline constexpr const char* kCompileGreeting = "clarity compile worker 1";
inline constexpr const char* kLoadGreeting = "clarity load worker 1";
inline constexpr const char* kTrialGreeting = "clarity trial worker 1";

// Begins a worker process: it ends when its parent does, logs to the parent, reports the cause of its death, and greets.
// Returns false, after a line on stderr, if this process was not started as a worker. parent: pid of the parent; 0: not known.
// instead: what a person should run, "to import a file, run `clarity info FILE`".
bool begin_worker(const char* greeting, long parent, const char* instead);

// Sets our signal handlers again, so that we report crashes. An OpenCL compiler (LLVM's) replaces them when it is loaded. With
// its handlers, a second thread that crashes at the same moment ends the process before anything is reported. Call this before
// others' code runs.
void take_crash_signals();

// Forwards progress to the parent, and its cancel to us.
class ChannelProgress : public Progress {
 public:
    void stage(const std::string& text) override;
    // Plugins report as often as they like; at most forty reports a second are sent to the parent.
    bool report(float fraction) override;

 private:
    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_look_{};
};

// Memory with a name. If the worker dies of an access to it or beside it, the message names it: "64 bytes behind slot nodes".
// element_bytes: of an array; its elements are then counted, too. 0: none. Thread-safe; at most kMostNamed ranges at a time.
constexpr unsigned kMostNamed = 256;
void name_memory(const void* begin, size_t bytes, const std::string& name, size_t element_bytes = 0);
void forget_memory(const void* begin);

}  // namespace clarity::worker
