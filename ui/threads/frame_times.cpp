#include "ui/threads/frame_times.hpp"

namespace clarity::ui {

void FrameTimes::add(const std::shared_ptr<const Ready>& of, double ms) {
    constexpr size_t kTimes = 240;
    if (of_ != of) {
        ms_.clear();
        of_ = of;
        cold_ = true;
    } else if (cold_) {
        ms_.clear();
        cold_ = false;
    }
    ms_.push_back(static_cast<float>(ms));
    if (ms_.size() > kTimes) ms_.erase(ms_.begin());
}

}  // namespace clarity::ui
