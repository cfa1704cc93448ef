// log_buffer.hpp -- the last lines of the program's log, for the window.
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

struct LogLine {
    LogLevel level;
    std::string text;  // may hold several lines: a compiler's log, say
    double at_s = 0;   // by the steady clock
};

// Listens to the program's log from its making to its end. Thread-safe.
class LogBuffer {
 public:
    explicit LogBuffer(std::function<void()> wake);
    ~LogBuffer();
    LogBuffer(const LogBuffer&) = delete;
    LogBuffer& operator=(const LogBuffer&) = delete;

    // Changes with every line.
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
