// watched.hpp -- progress of a call, told to the caller's function, and the caller's cancel.
#pragma once
#include <atomic>
#include <mutex>
#include <string>

#include "api/clarity.h"
#include "base/elapsed.hpp"
#include "base/progress.hpp"

namespace clarity::api {

class Watched : public Progress {
 public:
    explicit Watched(const clarity_watch& watch) : watch_(watch) {}
    void stage(const std::string& text) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        stage_ = text;
        tell(0);
    }
    // Work reports as often as it likes; the caller hears of twenty a second.
    bool report(float fraction) override {
        if (const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock); lock && now_s() - told_s_ > 0.05) tell(fraction);
        return !cancelled();
    }
    bool cancelled() const override { return Progress::cancelled() || (watch_.cancel && *watch_.cancel != 0); }

 private:
    void tell(float fraction) {
        told_s_ = now_s();
        if (watch_.progress && watch_.progress(watch_.user, stage_.c_str(), fraction) == 0) cancel();
    }
    const clarity_watch watch_;
    std::mutex mutex_;  // one call at a time
    std::string stage_;
    double told_s_ = 0;
};

}  // namespace clarity::api
