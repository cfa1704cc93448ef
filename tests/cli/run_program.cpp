#include "cli/run_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <stdexcept>

namespace {

using Clock = std::chrono::steady_clock;

struct OutputChannel {
    int read = -1, write = -1;
};

OutputChannel make_channel(bool terminal) {
    int ends[2];
    if (terminal) {
        if (openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0)
            throw std::runtime_error(std::string("no terminal (openpty): ") + std::strerror(errno) +
                                     "; is a devpts mounted at /dev/pts?");
    } else if (pipe(ends) != 0) {
        throw std::runtime_error("pipe failed");
    }
    for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
    return {ends[0], ends[1]};
}

// Runs in the child, between fork and exec.
[[noreturn]] void become(const std::vector<std::string>& words, const RunOptions& options, int out, int err) {
    // The process which runs the tests may ignore signals; the program under test must start as from a shell.
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) std::signal(signal, SIG_DFL);
    const int in = open("/dev/null", O_RDONLY);
    if (!options.stdout_path.empty()) out = open(options.stdout_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    unsetenv("CLARITY_COMPILE");  // as users do, in a worker
    for (const auto& [name, value] : options.environment)
        value.empty() ? unsetenv(name.c_str()) : setenv(name.c_str(), value.c_str(), 1);
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    execvp(argv[0], argv.data());
    _exit(127);
}

// Appends the available data. Returns false at the end. A terminal ends with EIO when its other side is closed.
bool drain(int from, std::string& to) {
    char buffer[65536];
    const ssize_t got = read(from, buffer, sizeof buffer);
    if (got > 0) to.append(buffer, static_cast<size_t>(got));
    return got > 0 || (got < 0 && errno == EINTR);
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& arguments, const RunOptions& options) {
    const char* program = std::getenv("CLARITY_WORKER");
    if (!program) throw std::runtime_error("CLARITY_WORKER does not name the program: run this test through ctest");
    std::vector<std::string> words = options.wrapper;
    words.push_back(program);
    words.insert(words.end(), arguments.begin(), arguments.end());

    const OutputChannel out = make_channel(false), err = make_channel(options.terminal);
    const auto begin = Clock::now();
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) become(words, options, out.write, err.write);
    close(out.write);
    close(err.write);

    ProgramResult result;
    std::optional<double> signalled_s;
    const bool signals = options.signal_after_s >= 0 || !options.signal_when.empty() || !options.signal_when_made.empty();
    bool out_open = true, err_open = true;
    while (out_open || err_open) {
        pollfd waits[2] = {{out_open ? out.read : -1, POLLIN, 0}, {err_open ? err.read : -1, POLLIN, 0}};
        poll(waits, 2, 10);
        if (waits[0].revents) out_open = drain(out.read, result.out);
        if (waits[1].revents) err_open = drain(err.read, result.err);
        const bool is_late = options.signal_after_s < 0 || elapsed() >= options.signal_after_s;
        const bool is_said = options.signal_when.empty() || result.err.find(options.signal_when) != std::string::npos;
        const bool is_made = options.signal_when_made.empty() || access(options.signal_when_made.c_str(), F_OK) == 0;
        if (signals && !signalled_s && is_late && is_said && is_made) {
            kill(child, options.signal);
            signalled_s = elapsed();
        }
        if (elapsed() > options.limit_s) kill(child, SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    close(out.read);
    close(err.read);
    result.seconds = elapsed();
    result.seconds_after_signal = result.seconds - signalled_s.value_or(result.seconds);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}
