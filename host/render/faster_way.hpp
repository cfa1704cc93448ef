// faster_way.hpp -- the fastest of several ways to do the same thing, found out by doing it.
#pragma once
#include <algorithm>
#include <array>

namespace clarity {

// In turns, each three times, of which the lesser of the last two counts: the first may be cut into small pieces and hold a
// compilation.
class FasterWay {
 public:
    // kMost ways at most.
    explicit FasterWay(unsigned ways = 1) : ways_(ways) { ms_.fill(1e30); }
    unsigned way() const { return tried_ < kRounds * ways_ ? tried_ % ways_ : best(); }
    void took(double ms) {
        if (tried_ >= kRounds * ways_) return;
        double& least = ms_[tried_ % ways_];
        if (tried_++ >= ways_) least = std::min(least, ms);
    }

    static constexpr unsigned kMost = 3;

 private:
    static constexpr unsigned kRounds = 3;
    static constexpr double kWorthIt = 0.97;  // of the first way's time: less is noise

    unsigned best() const {
        const auto least = std::min_element(ms_.begin(), ms_.begin() + ways_);
        return *least < kWorthIt * ms_[0] ? static_cast<unsigned>(least - ms_.begin()) : 0;
    }

    unsigned ways_, tried_ = 0;
    std::array<double, kMost> ms_;
};

}  // namespace clarity
