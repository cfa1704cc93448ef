// log_buffer.hpp -- the last 2000 entries of the program's log, for the window.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/log.hpp"

namespace clarity::ui {

// One entry of the log.
struct LogLine {
    LogLevel level;
    std::string text;  // may have several lines, such as a compiler's log
    double at_s = 0;   // seconds of the steady clock
};

// Collects the program's log while it exists. Thread-safe.
class LogBuffer {
 public:
    explicit LogBuffer(std::function<void()> wake);
    ~LogBuffer();
    LogBuffer(const LogBuffer&) = delete;
    LogBuffer& operator=(const LogBuffer&) = delete;

    // A number which changes with every new entry.
    uint64_t revision() const;
    std::vector<LogLine> lines() const;
    std::optional<LogLine> last() const;
    void clear();

 private:
    static constexpr size_t kLines = 2000;
    mutable std::mutex mutex_;
    std::deque<LogLine> lines_;
    uint64_t revision_ = 0;
};

}  // namespace clarity::ui
