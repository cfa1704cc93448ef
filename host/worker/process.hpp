// process.hpp -- starts and ends a worker process, and owns its descriptors.
#pragma once
#include <spawn.h>
#include <sys/types.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/memory_file.hpp"

namespace clarity::worker {

// Owns a file descriptor and closes it.
class FileDescriptor {
 public:
    explicit FileDescriptor(int fd = -1) : fd_(fd) {}
    ~FileDescriptor() { reset(); }
    FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    FileDescriptor& operator=(FileDescriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    int get() const { return fd_; }
    void reset();

 private:
    int fd_;
};

// What worker_program() returns in the program itself.
inline constexpr const char* kThisProgram = "/proc/self/exe";
// The program that runs as worker: the one that CLARITY_WORKER names, or program_file().
std::string worker_program();

// A worker process. The destructor kills it if it still runs, and waits for its end.
class WorkerProcess {
 public:
    // Starts the program words[0] with these words. It finds `arguments` at kArgumentsFd. Throws Error(code) if that fails.
    WorkerProcess(std::vector<std::string> words, const MemoryFile& arguments, Exit code);
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    int channel() const { return channel_.get(); }
    // Shared memory for the worker's result; empty at the start.
    const MemoryFile& result() const { return result_; }
    pid_t pid() const { return pid_; }
    // Pipe with everything that the worker and its libraries print; non-blocking.
    int output() const { return output_.get(); }
    void kill_now();
    // Waits until the process has ended; returns the status of waitpid().
    int wait();
    // Resident memory in bytes; 0 if it is not known.
    uint64_t resident_bytes() const;
    // Processor time that it has used so far, of all its threads; negative if it is not known.
    double processor_s() const;
    // Lets the worker map this many bytes more than now, up to its own hard limit.
    void raise_memory_limit(uint64_t more_bytes) const;

 private:
    pid_t pid_ = -1;
    int status_ = 0;
    FileDescriptor channel_, output_;
    MemoryFile result_;
};

// Starts a program in a process group of its own.

// How a program is started. Ctrl-C reaches only us, so that we turn it into a cancel, and its signals have the default
// handlers. It reads nothing from stdin, and gets no descriptors but those given.
class Spawn {
 public:
    Spawn();
    ~Spawn();
    Spawn(const Spawn&) = delete;
    Spawn& operator=(const Spawn&) = delete;

    // Our descriptor becomes the program's descriptor `number`.
    void give(int descriptor, int number);
    // Starts the program words[0], found by PATH if it has no slash. environment: ends with nullptr. Returns 0, or the number
    // of what went wrong.
    int start(std::vector<std::string>& words, char* const* environment, pid_t& pid);

 private:
    posix_spawn_file_actions_t files_;
    posix_spawnattr_t attributes_;
};

}  // namespace clarity::worker
