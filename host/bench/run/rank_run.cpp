#include "bench/run/rank_run.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <sstream>
#include <thread>

#include "base/digest.hpp"
#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/read_file.hpp"
#include "base/printable.hpp"

namespace clarity::bench {
namespace {

using Clock = std::chrono::steady_clock;

// What a started program leaves behind.
struct Ended {
    int status = 0;  // as waitpid() tells it
    double ms = 0;
};

// Sends a signal to the program and to what it has started.
void send(pid_t group, int signal) {
    kill(-group, signal);
}

// Starts a program in a process group of its own, so that Ctrl-C reaches only us, and waits for its end. messages: a file for
// its stdout and stderr.
Ended run_program(std::vector<std::string> words, const std::string& messages, const std::string& install,
                  const Progress& progress) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&files, 1, 2);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setpgroup(&attributes, 0);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const auto begin = Clock::now();
    pid_t pid = -1;
    const int error = posix_spawnp(&pid, arguments[0], &files, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw Error(Exit::failed, words[0] + " cannot be started: " + std::strerror(error) + "; " + install);
    constexpr double kPatienceMs = 5000;  // mpirun ends the ranks when it gets SIGTERM
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
            send(pid, SIGTERM);
        } else if (asked && ms_since(cancelled) > kPatienceMs) {
            send(pid, SIGKILL);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

std::string cause(int status) {
    if (WIFSIGNALED(status)) return std::string("ended by signal ") + strsignal(WTERMSIG(status));
    return "exit code " + std::to_string(WEXITSTATUS(status));
}

// Lines of the program itself, or else the first ones of mpirun, which frames its messages.
std::string words_of(const std::string& messages) {
    constexpr size_t kMostLines = 6;
    std::string ours, theirs;
    size_t lines = 0;
    std::istringstream in(messages);
    for (std::string line; std::getline(in, line);) {
        if (line.find_first_not_of("- \t\r") == std::string::npos) continue;
        if (line.compare(0, 7, "error: ") == 0 && ours.find(line) == std::string::npos) ours += "\n" + line;
        if (++lines <= kMostLines) theirs += "\n" + line;
    }
    return printable(ours.empty() ? theirs : ours);
}

}  // namespace

RankRun run_render(std::vector<std::string> words, const std::string& folder, const std::string& install,
                   const Progress& progress) {
    const std::string stats = folder + "/stats.json", picture = folder + "/picture.pfm", messages = folder + "/messages";
    unlink(stats.c_str());
    unlink(picture.c_str());
    for (const std::string& word : {std::string("-q"), std::string("-o"), picture, std::string("--stats"), stats})
        words.push_back(word);
    const Ended ended = run_program(words, messages, install, progress);
    if (!WIFEXITED(ended.status) || WEXITSTATUS(ended.status) != 0)
        throw Error(Exit::failed, cause(ended.status) + words_of(read_file(messages, kMaxTextFileBytes, Exit::failed)));
    RankRun run;
    run.whole_ms = ended.ms;
    try {
        run.stats = nlohmann::json::parse(read_file(stats, kMaxTextFileBytes, Exit::failed));
    } catch (const nlohmann::json::exception&) {
        throw Error(Exit::failed, stats + ": is no JSON: do all ranks run the same version of the program?");
    }
    run.picture = digest_of_file(picture);
    if (run.picture.empty()) throw Error(Exit::failed, picture + ": cannot be read");
    return run;
}

RankRunner::RankRunner(const std::string& mpirun, std::vector<std::string> render)
    : folder_("clarity-ranks"), render_(std::move(render)) {
    std::istringstream words(mpirun);
    for (std::string word; words >> word;) mpirun_.push_back(word);
    if (mpirun_.empty()) throw Error(Exit::usage, "--mpirun: name a program, as in --mpirun \"mpirun --oversubscribe\"");
}

RankRun RankRunner::run(unsigned ranks, const std::string& device, const Progress& progress) const {
    std::vector<std::string> words = mpirun_;
    for (const std::string& word : {std::string("-n"), std::to_string(ranks), program_file().string(), std::string("render")})
        words.push_back(word);
    words.insert(words.end(), render_.begin(), render_.end());
    for (const std::string& word : {std::string("--mpi"), std::string("--device"), device}) words.push_back(word);
    try {
        return run_render(words, folder_.path(),
                          "install Open MPI (Debian: openmpi-bin), or name what starts ranks with --mpirun", progress);
    } catch (const Error& e) {
        throw Error(e.code(), mpirun_[0] + " -n " + std::to_string(ranks) + ": " + e.what());
    }
}

}  // namespace clarity::bench
