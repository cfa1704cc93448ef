// faster_way.hpp -- the fastest of several ways to do the same thing, found out by doing it.
#pragma once
#include <algorithm>
#include <array>

namespace clarity {

// In turns, each three times, of which the lesser of the last two counts: the first may be cut into small pieces and hold a
// compilation. What was far behind the second time is not tried a third.
class FasterWay {
 public:
    // kMost ways at most.
    explicit FasterWay(unsigned ways = 1) : ways_(ways) { ms_.fill(1e30); }
    unsigned way() const { return round_ < kRounds ? at_ : best(); }
    void took(double ms) {
        if (round_ == kRounds) return;
        if (round_ > 0) ms_[at_] = std::min(ms_[at_], ms);
        do {
            if (++at_ < ways_) continue;
            at_ = 0;
            if (++round_ == kRounds - 1) worth_a_third_ = kFarBehind * ms_[fastest()];
        } while (round_ == kRounds - 1 && ms_[at_] > worth_a_third_);
    }

    static constexpr unsigned kMost = 5;

 private:
    static constexpr unsigned kRounds = 3;
    static constexpr double kFarBehind = 1.5;
    static constexpr double kWorthIt = 0.97;  // of the first way's time: less is noise

    unsigned fastest() const { return static_cast<unsigned>(std::min_element(ms_.begin(), ms_.begin() + ways_) - ms_.begin()); }
    unsigned best() const { return ms_[fastest()] < kWorthIt * ms_[0] ? fastest() : 0; }

    unsigned ways_, round_ = 0, at_ = 0;
    double worth_a_third_ = 0;  // what took longer is not
    std::array<double, kMost> ms_;
};

}  // namespace clarity
