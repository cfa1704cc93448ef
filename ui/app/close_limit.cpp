#include "ui/app/close_limit.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "base/files/pending_write.hpp"
#include "base/files/process_folder.hpp"
#include "base/log.hpp"

namespace clarity::ui {

CloseLimit::CloseLimit(double seconds) : thread_([this, seconds] { run(seconds); }) {}

CloseLimit::~CloseLimit() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        closed_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void CloseLimit::run(double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto closed = [this] { return closed_; };
    do
        if (changed_.wait_for(lock, std::chrono::duration<double>(seconds), closed)) return;
    while (PendingWrite::any());
    log(LogLevel::warning, "the OpenCL driver did not stop within " + std::to_string(static_cast<int>(seconds)) +
                               " s after the window was closed, so the program was ended");
    std::fflush(nullptr);
    leave_process_folders();
    _exit(0);
}

}  // namespace clarity::ui
