#include "tools/bench/run/program.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <future>
#include <iterator>
#include <optional>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/files/temporary_folder.hpp"
#include "base/text.hpp"
#include "tools/bench/output/output.hpp"
#include "worker/process.hpp"

extern char** environ;

namespace clarity::bench {
namespace {

using Clock = std::chrono::steady_clock;

// mpirun ends the ranks when it gets SIGTERM, and the bench writes its rows.
constexpr double kPatienceMs = 5000;

constexpr uint64_t kMostBytes = uint64_t{1} << 30;

// Lets this process, and those that it starts, use only the first `count` of its processors while the object lives.
class FewProcessors {
 public:
    explicit FewProcessors(unsigned count) {
        // It fails on machines of more than CPU_SETSIZE processors.
        if (sched_getaffinity(0, sizeof all_, &all_) != 0)
            throw Error(Exit::failed,
                        std::string("--threads: the processors of this process are not known: ") + std::strerror(errno));
        cpu_set_t few;
        CPU_ZERO(&few);
        for (size_t i = 0; i < CPU_SETSIZE && CPU_COUNT(&few) < int(count); ++i)
            if (CPU_ISSET(i, &all_)) CPU_SET(i, &few);
        if (sched_setaffinity(0, sizeof few, &few) != 0)
            throw Error(Exit::failed, std::string("--threads: the processors cannot be chosen: ") + std::strerror(errno));
        for (size_t i = 0; i < std::size(kPoclThreads); ++i) {
            if (const char* value = std::getenv(kPoclThreads[i])) before_[i] = value;
            setenv(kPoclThreads[i], std::to_string(count).c_str(), 1);
        }
    }
    ~FewProcessors() {
        sched_setaffinity(0, sizeof all_, &all_);
        for (size_t i = 0; i < std::size(kPoclThreads); ++i)
            before_[i] ? setenv(kPoclThreads[i], before_[i]->c_str(), 1) : unsetenv(kPoclThreads[i]);
    }
    FewProcessors(const FewProcessors&) = delete;
    FewProcessors& operator=(const FewProcessors&) = delete;

 private:
    // of PoCL 3 and 5
    static constexpr const char* kPoclThreads[] = {"POCL_MAX_PTHREAD_COUNT", "POCL_CPU_MAX_CU_COUNT"};
    cpu_set_t all_;
    std::optional<std::string> before_[std::size(kPoclThreads)];
};

}  // namespace

Ended run_program(std::vector<std::string> words, const std::string& messages, const char* install, const Progress& progress) {
    const worker::FileDescriptor output(
        open(messages.empty() ? "/dev/null" : messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    if (output.get() < 0) throw Error(Exit::failed, messages + ": cannot be written: " + std::strerror(errno));
    worker::Spawn spawn;
    spawn.give(output.get(), 1);
    spawn.give(messages.empty() ? 2 : output.get(), 2);
    const auto begin = Clock::now();
    pid_t pid = -1;
    if (const int error = spawn.start(words, environ, pid))
        throw Error(Exit::failed, words[0] + " cannot be started: " + std::strerror(error) + "; " + install);
    // A thread waits for the end, so that its time is not that of a turn of this loop.
    auto ended = std::async(std::launch::async, [&] {
        siginfo_t info;
        while (waitid(P_PID, id_t(pid), &info, WEXITED | WNOWAIT) != 0)
            if (errno != EINTR) throw Error(Exit::failed, words[0] + ": " + std::strerror(errno));
        return ms_since(begin);
    });
    Clock::time_point cancelled;
    bool asked = false;
    while (ended.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
        if (progress.cancelled() && !asked) {
            asked = true;
            cancelled = Clock::now();
            kill(-pid, SIGTERM);
        } else if (asked && ms_since(cancelled) > kPatienceMs) {
            kill(-pid, SIGKILL);
        }
    }
    Ended end{0, ended.get()};
    waitpid(pid, &end.status, 0);
    if (asked) throw Cancelled();
    return end;
}

void check_thread_counts(const std::vector<unsigned>& counts) {
    cpu_set_t mine;
    if (sched_getaffinity(0, sizeof mine, &mine) != 0) return;
    for (const unsigned count : counts)
        if (count > unsigned(CPU_COUNT(&mine)))
            throw Error(Exit::usage, "--threads " + std::to_string(count) + ": this process may use " +
                                         plural(size_t(CPU_COUNT(&mine)), "processor", "processors") + "; name no more");
}

std::vector<BenchReport> run_by_threads(const std::vector<std::string>& words, const std::vector<unsigned>& counts,
                                        Progress& progress) {
    const TemporaryFolder folder("clarity-bench");
    std::vector<BenchReport> reports;
    for (const unsigned count : counts) {
        progress.stage("bench with " + plural(count, "thread", "threads"));
        const std::string json = folder.path() + "/" + std::to_string(count) + ".json";
        std::vector<std::string> line = {"/proc/self/exe", "bench"};
        line.insert(line.end(), words.begin(), words.end());
        line.insert(line.end(), {"--json", json});
        bool cancelled = false;
        try {
            const FewProcessors few(count);
            run_program(line, "", "the program was moved or deleted while it ran", progress);
        } catch (const Cancelled&) {
            cancelled = true;
        }
        try {
            reports.push_back(read_bench_json(read_file(json, kMostBytes, Exit::failed)));
        } catch (const Error& error) {
            if (!cancelled)
                throw Error(Exit::failed,
                            "bench with " + plural(count, "thread", "threads") + " wrote no records: " + error.what());
        }
        if (!cancelled) continue;
        if (reports.empty()) throw Cancelled();
        reports.back().interrupted = true;
        break;
    }
    return reports;
}

}  // namespace clarity::bench
