// rows.cpp -- what `clarity bench` and `clarity check` find: they run in a process of their own, which plugins may crash.
#include "api/rows.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <array>
#include <cerrno>
#include <cstring>

#include "api/library.hpp"
#include "worker/process.hpp"

extern char** environ;

namespace clarity::api {
namespace {

// A program with its two outputs in pipes. The destructor ends it.
class Child {
 public:
    explicit Child(std::vector<std::string>& words) {
        worker::Spawn spawn;
        std::array<worker::FileDescriptor, 2> theirs;
        for (int i = 0; i < 2; ++i) {
            int ends[2];
            if (pipe2(ends, O_CLOEXEC) != 0) fail(words[0], errno);
            outputs_[i] = worker::FileDescriptor(ends[0]);
            theirs[i] = worker::FileDescriptor(ends[1]);
            fcntl(ends[0], F_SETFL, O_NONBLOCK);
            spawn.give(ends[1], i + 1);
        }
        if (const int error = spawn.start(words, environ, pid_)) {
            pid_ = -1;
            fail(words[0], error);
        }
    }
    ~Child() {
        if (pid_ <= 0) return;
        kill(-pid_, SIGKILL);
        wait();
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    // Appends what is printed until the end.
    void read_all(std::string& out, std::string& err, Progress& progress) {
        std::string* const texts[] = {&out, &err};
        pollfd polled[] = {{outputs_[0].get(), POLLIN, 0}, {outputs_[1].get(), POLLIN, 0}};
        while (polled[0].fd >= 0 || polled[1].fd >= 0) {
            if (!progress.report(-1)) throw Cancelled();
            poll(polled, 2, kLookMs);
            for (int i = 0; i < 2; ++i) {
                if (polled[i].fd < 0 || polled[i].revents == 0) continue;
                char some[65536];
                const ssize_t count = read(polled[i].fd, some, sizeof some);
                if (count > 0)
                    texts[i]->append(some, static_cast<size_t>(count));
                else if (count == 0 || (errno != EAGAIN && errno != EINTR))
                    polled[i].fd = -1;
            }
        }
    }
    // The status of waitpid().
    int wait() {
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        pid_ = -1;
        return status;
    }

 private:
    static constexpr int kLookMs = 50;  // for a cancel
    [[noreturn]] static void fail(const std::string& program, int error) {
        throw Error(Exit::failed, "cannot start " + program + ": " + std::strerror(error) +
                                      "; name the program `clarity` by clarity_set_program() or in CLARITY_WORKER");
    }
    pid_t pid_ = -1;
    std::array<worker::FileDescriptor, 2> outputs_;
};

}  // namespace

void give_rows(std::vector<std::string> words, const std::function<void(const std::string& json)>& row, Progress& progress) {
    if (words.empty() || (words[0] != "bench" && words[0] != "check"))
        throw Error(Exit::usage, "expected the words of `clarity bench` or of `clarity check`");
    const std::string command = words[0];
    progress.stage("clarity " + command);
    plugins();  // finds the program
    std::vector<std::string> line = {worker::worker_program(), command, "--quiet", "--json"};
    if (command == "bench") line.emplace_back("-");
    line.insert(line.end(), words.begin() + 1, words.end());
    std::string out, err;
    Child child(line);
    child.read_all(out, err, progress);
    const int status = child.wait();
    if (WIFSIGNALED(status))
        throw Error(Exit::failed,
                    "clarity " + command + " was ended by the signal " + std::to_string(WTERMSIG(status)) + ": " + err);
    const auto rows = nlohmann::json::parse(out, nullptr, false);
    // Code 1 with rows: some of them are failed or refused, and say so.
    if (WEXITSTATUS(status) > 1 || !rows.is_array()) {
        const std::string prefix = "error: ";
        if (err.compare(0, prefix.size(), prefix) == 0) err.erase(0, prefix.size());
        while (!err.empty() && err.back() == '\n') err.pop_back();
        throw Error(WEXITSTATUS(status) ? static_cast<Exit>(WEXITSTATUS(status)) : Exit::failed,
                    err.empty() ? "clarity " + command + " printed no rows" : err);
    }
    for (const auto& one : rows) row(one.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace clarity::api
