// progress_bar.hpp -- a progress bar: one line on stderr which is redrawn in place.
#pragma once
#include <chrono>
#include <mutex>
#include <string>

#include "base/progress.hpp"

namespace clarity {

// Shows nothing if stderr is not a terminal, or if `quiet`. Thread-safe.
class ProgressBar : public Progress {
 public:
    explicit ProgressBar(bool quiet);
    ~ProgressBar() override;
    void stage(const std::string& name) override;
    bool report(float fraction) override;
    // Erases the line; to be called before anything is printed to stdout.
    void clear();

 private:
    using Clock = std::chrono::steady_clock;
    void draw(float fraction, Clock::time_point now);

    const bool shown_;
    bool color_ = false, drawn_ = false;
    std::mutex mutex_;
    std::string name_;
    Clock::time_point begun_, last_;
};

}  // namespace clarity
