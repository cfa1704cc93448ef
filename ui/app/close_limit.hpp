// close_limit.hpp -- ends the program if its threads do not. No call of OpenCL stops a launch on a CPU, or returns from a call
// that hangs in a driver, so a window that waited for its threads would stay as a process without a window.
#pragma once
#include <condition_variable>
#include <mutex>
#include <thread>

namespace clarity::ui {

// If this object lives longer than the limit and no picture is being written, the process ends with exit code 0, after a line
// on stderr. Nothing is lost: the caller has saved what is to be kept, and the kernel ends our workers with us.
class CloseLimit {
 public:
    explicit CloseLimit(double seconds);
    ~CloseLimit();
    CloseLimit(const CloseLimit&) = delete;
    CloseLimit& operator=(const CloseLimit&) = delete;

 private:
    void run(double seconds);

    std::mutex mutex_;
    std::condition_variable changed_;
    bool closed_ = false;
    std::thread thread_;  // last member: the thread starts when all others exist
};

}  // namespace clarity::ui
