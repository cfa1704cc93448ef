#include "worker/process.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "worker/channel.hpp"

extern char** environ;

namespace clarity::worker {
namespace {

struct StartFailure {
    std::string what;
    int error;
};
[[noreturn]] void fail(const std::string& what, int error) {
    throw StartFailure{what, error};
}

int checked(int fd, const char* what) {
    if (fd < 0) fail(what, errno);
    return fd;
}

// A copy of a descriptor with a number above those that the worker's descriptors get.
FileDescriptor copied_up(int fd) {
    return FileDescriptor(checked(fcntl(fd, F_DUPFD_CLOEXEC, 10), "descriptor"));
}
FileDescriptor moved_up(int fd) {
    const FileDescriptor low(fd);
    return copied_up(fd);
}

}  // namespace

void FileDescriptor::reset() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
}

std::string worker_program() {
    const char* named = std::getenv("CLARITY_WORKER");
    if (named && *named) return named;
    return is_library() ? program_file().string() : kThisProgram;
}

WorkerProcess::WorkerProcess(std::vector<std::string> words, const MemoryFile& arguments, Exit code) try {
    int pair[2], pipe_ends[2];
    checked(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair), "socket pair");
    channel_ = moved_up(pair[0]);
    const FileDescriptor their_channel = moved_up(pair[1]);
    checked(pipe2(pipe_ends, O_CLOEXEC), "pipe");
    output_ = moved_up(pipe_ends[0]);
    const FileDescriptor their_output = moved_up(pipe_ends[1]);
    fcntl(output_.get(), F_SETFL, O_NONBLOCK);

    const FileDescriptor their_result = copied_up(result_.fd()), their_arguments = copied_up(arguments.fd());

    Spawn spawn;
    for (const int number : {1, 2}) spawn.give(their_output.get(), number);
    spawn.give(their_channel.get(), kChannelFd);
    spawn.give(their_result.get(), kResultFd);
    spawn.give(their_arguments.get(), kArgumentsFd);
    const std::string variable = std::string(kWorkerVariables[0]) + "=1";
    std::vector<char*> environment;
    for (char** entry = environ; *entry; ++entry) environment.push_back(*entry);
    environment.push_back(const_cast<char*>(variable.c_str()));
    environment.push_back(nullptr);
    if (const int error = spawn.start(words, environment.data(), pid_)) {
        pid_ = -1;
        fail(words.front(), error);
    }
} catch (const StartFailure& failure) {
    throw Error(code, "cannot start the worker process: " + failure.what + ": " + std::strerror(failure.error) +
                          "; name the program `clarity` in CLARITY_WORKER or unset it");
}

WorkerProcess::~WorkerProcess() {
    kill_now();
    wait();
}

void WorkerProcess::kill_now() {
    if (pid_ <= 0) return;
    ::kill(-pid_, SIGKILL);  // its group: what it has started, such as compilers
    ::kill(pid_, SIGKILL);
}

int WorkerProcess::wait() {
    while (pid_ > 0) {
        if (waitpid(pid_, &status_, 0) == pid_ || errno != EINTR) pid_ = -1;
    }
    return status_;
}

void WorkerProcess::raise_memory_limit(uint64_t more_bytes) const {
    rlimit now{};
    if (pid_ <= 0 || prlimit(pid_, RLIMIT_AS, nullptr, &now) != 0 || now.rlim_cur == RLIM_INFINITY) return;
    now.rlim_cur = std::min<rlim_t>(now.rlim_cur + more_bytes, now.rlim_max);
    prlimit(pid_, RLIMIT_AS, &now, nullptr);
}

double WorkerProcess::processor_s() const {
    clockid_t clock;
    timespec now{};
    if (pid_ <= 0 || clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &now) != 0) return -1;
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

uint64_t WorkerProcess::resident_bytes() const {
    if (pid_ <= 0) return 0;
    std::FILE* file = std::fopen(("/proc/" + std::to_string(pid_) + "/statm").c_str(), "re");
    if (!file) return 0;
    unsigned long long total = 0, resident = 0;
    const bool read = std::fscanf(file, "%llu %llu", &total, &resident) == 2;
    std::fclose(file);
    return read ? resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

Spawn::Spawn() {
    posix_spawn_file_actions_init(&files_);
    posix_spawn_file_actions_addopen(&files_, 0, "/dev/null", O_RDONLY, 0);
    posix_spawnattr_init(&attributes_);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
}

Spawn::~Spawn() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&files_);
}

void Spawn::give(int descriptor, int number) {
    posix_spawn_file_actions_adddup2(&files_, descriptor, number);
}

int Spawn::start(std::vector<std::string>& words, char* const* environment, pid_t& pid) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    return posix_spawnp(&pid, argv[0], &files_, &attributes_, argv.data(), environment);
}

}  // namespace clarity::worker
