#include "bench/run/program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "worker/process.hpp"
#include "worker/spawn.hpp"

extern char** environ;

namespace clarity::bench {
namespace {

using Clock = std::chrono::steady_clock;

// mpirun ends the ranks when it gets SIGTERM, and the bench writes its rows.
constexpr double kPatienceMs = 5000;

}  // namespace

Ended run_program(std::vector<std::string> words, const std::string& messages, const char* install, const Progress& progress) {
    const worker::FileDescriptor output(
        open(messages.empty() ? "/dev/null" : messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    worker::Spawn spawn;
    spawn.give(output.get(), 1);
    spawn.give(messages.empty() ? 2 : output.get(), 2);
    const auto begin = Clock::now();
    pid_t pid = -1;
    if (const int error = spawn.start(words, environ, pid))
        throw Error(Exit::failed, words[0] + " cannot be started: " + std::strerror(error) + "; " + install);
    Clock::time_point cancelled;
    for (bool asked = false;;) {
        int status = 0;
        const pid_t ended = waitpid(pid, &status, WNOHANG);
        if (ended < 0 && errno != EINTR) throw Error(Exit::failed, words[0] + ": " + std::strerror(errno));
        if (ended == pid) {
            if (asked) throw Cancelled();
            return {status, ms_since(begin)};
        }
        if (progress.cancelled() && !asked) {
            asked = true;
            cancelled = Clock::now();
            kill(-pid, SIGTERM);
        } else if (asked && ms_since(cancelled) > kPatienceMs) {
            kill(-pid, SIGKILL);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace clarity::bench
