#include "ui/threads/frame_times.hpp"

#include <algorithm>
#include <cstddef>

namespace clarity::ui {

void FrameTimes::add(const std::shared_ptr<const Ready>& of, const PictureSide& side) {
    constexpr size_t kTimes = 240;
    const bool same = of_ == of || (of_ && of && traces_alike(*of_, *of));
    of_ = of;
    if (!same || cold_) {
        frames_ms_.clear();
        kernels_ms_.clear();
        cold_ = !same;
    }
    const auto append = [](std::vector<float>& times, double ms) {
        times.push_back(static_cast<float>(ms));
        if (times.size() > kTimes) times.erase(times.begin());
    };
    append(frames_ms_, side.frame_ms);
    append(kernels_ms_, side.kernels_ms());
}

std::vector<float> FrameTimes::recent_kernels_ms() const {
    return {kernels_ms_.end() - std::min<std::ptrdiff_t>(30, kernels_ms_.end() - kernels_ms_.begin()), kernels_ms_.end()};
}

}  // namespace clarity::ui
