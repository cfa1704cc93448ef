#include "base/files/times_watch.hpp"

#include <sys/stat.h>

#include <chrono>

namespace clarity {

TimesWatch::State TimesWatch::look(const std::string& path) {
    struct stat now {};
    if (stat(path.c_str(), &now) != 0) return {};
    return {int64_t(now.st_mtim.tv_sec) * 1000000000 + now.st_mtim.tv_nsec, static_cast<uint64_t>(now.st_size),
            static_cast<uint64_t>(now.st_ino), true};
}

TimesWatch::TimesWatch(std::vector<std::string> files, std::function<void()> changed)
    : files_(std::move(files)), changed_(std::move(changed)) {
    for (const std::string& file : files_) known_.push_back(look(file));
    seen_ = known_;
    thread_ = std::thread([this] { run(); });
}

TimesWatch::~TimesWatch() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

std::string TimesWatch::last_changed() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_changed_;
}

void TimesWatch::run() {
    constexpr auto kPeriod = std::chrono::milliseconds(500), kWhileWritten = std::chrono::milliseconds(100);
    auto period = kPeriod;
    for (;;) {
        {
            std::unique_lock<std::mutex> lock(mutex_);
            if (wake_.wait_for(lock, period, [this] { return stop_; })) return;
        }
        bool rests = true;
        std::string changed;
        for (size_t i = 0; i < files_.size(); ++i) {
            const State now = look(files_[i]);
            if (now != seen_[i]) rests = false;
            seen_[i] = now;
            if (!now.exists && known_[i].exists) rests = false;  // removed, or replaced in a moment
            if (now.exists && now != known_[i]) changed = files_[i];
        }
        period = rests && changed.empty() ? kPeriod : kWhileWritten;
        if (!rests || changed.empty()) continue;
        known_ = seen_;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            last_changed_ = changed;
        }
        ++revision_;
        period = kPeriod;
        changed_();
    }
}

}  // namespace clarity
