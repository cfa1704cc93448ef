#include "ui/session/log_buffer.hpp"

#include <chrono>

namespace clarity::ui {

LogBuffer::LogBuffer(std::function<void()> wake) {
    set_log_listener([this, wake = std::move(wake)](LogLevel level, const std::string& text) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            using Seconds = std::chrono::duration<double>;
            lines_.push_back({level, text, Seconds(std::chrono::steady_clock::now().time_since_epoch()).count()});
            if (lines_.size() > kLines) lines_.pop_front();
            ++revision_;
        }
        wake();
    });
}

LogBuffer::~LogBuffer() {
    set_log_listener({});
}

uint64_t LogBuffer::revision() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return revision_;
}

std::vector<LogLine> LogBuffer::lines() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return {lines_.begin(), lines_.end()};
}

std::optional<LogLine> LogBuffer::last() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (lines_.empty()) return std::nullopt;
    return lines_.back();
}

void LogBuffer::clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.clear();
    ++revision_;
}

}  // namespace clarity::ui
