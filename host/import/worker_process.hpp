// worker_process.hpp -- a worker process and its descriptors.
#pragma once
#include <sys/types.h>
#include <cstdint>

#include <string>
#include <utility>
#include <vector>

namespace clarity::import {

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

// Killed, if it still runs, and waited for when it goes out of scope.
class WorkerProcess {
 public:
    // Starts `program import-worker ARGUMENTS...`. Throws Error(import_failed) if that cannot be done.
    WorkerProcess(const std::string& program, const std::vector<std::string>& arguments);
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    int channel() const { return channel_.get(); }
    int result() const { return result_.get(); }
    // What it and its libraries print; does not block.
    int output() const { return output_.get(); }
    void kill_now();
    // Waits for the end; status as waitpid gives it.
    int wait();
    uint64_t resident_bytes() const;
    // Lets it map that much more than it may now, up to its own hard limit.
    void raise_memory_limit(uint64_t more_bytes) const;

 private:
    pid_t pid_ = -1;
    int status_ = 0;
    FileDescriptor channel_, result_, output_;
};

}  // namespace clarity::import
