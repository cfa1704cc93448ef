// child.hpp -- the worker's side: how a worker process begins, reports, and tells why it dies.
#pragma once
#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "worker/channel.hpp"
#include "worker/job.hpp"
#include "worker/sandbox.hpp"

namespace clarity::worker {

// The kind whose worker this process is to be, by its first argument; nullptr: none.
const JobKind* kind_of_worker(int argc, char** argv, const std::vector<const JobKind*>& kinds);

// The main function of a worker. The process ends when its parent does, logs to the parent, and reports the cause of its death.
// Returns only if it was not started as a worker, after a line on stderr.
int worker_main(const JobKind& kind, int argc, char** argv);

// What JobKind::main needs: the arguments, which may refer to the parcel's memory, and the result, written once at its end.
template <class Arguments>
Arguments arguments_in(ParcelReader& parcel) {
    Arguments arguments;
    parcel(arguments);
    parcel.end();
    return arguments;
}
template <class Result>
void answer(Result&& result) {
    allow_writing_result();
    MemoryFile file = MemoryFile::of(kResultFd);
    ParcelWriter parcel(file);
    parcel(result);
    parcel.finish();
}

// Tells that a step of the work begins, before it does. limit_s: seconds that it may take; 0: as long as the one before.
void say_step(const std::string& text, double limit_s = 0);

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
