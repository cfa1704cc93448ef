#include "ui/threads/frame_times.hpp"

namespace clarity::ui {

void FrameTimes::add(const std::shared_ptr<const Ready>& of, double ms) {
    constexpr size_t kTimes = 240;
    const bool same = of_ == of || (of_ && of && traces_alike(*of_, *of));
    of_ = of;
    if (!same) {
        ms_.clear();
        cold_ = true;
    } else if (cold_) {
        ms_.clear();
        cold_ = false;
    }
    ms_.push_back(static_cast<float>(ms));
    if (ms_.size() > kTimes) ms_.erase(ms_.begin());
}

}  // namespace clarity::ui
