#include "render/launch/pace.hpp"

#include <algorithm>
#include <limits>

namespace clarity {
namespace {

constexpr double kPieceMs = 200, kFirstPieceMs = 50;
constexpr unsigned kFirstGroups = 4, kGrowth = 4;
constexpr double kTellingMs = 5;  // shorter pieces mostly measure the launch itself

}  // namespace

void Pace::begin_picture() {
    slowest_ = all_groups_ = all_ms_ = 0;
    last_ = pieces_ = 0;
}

unsigned Pace::next(unsigned left, unsigned most) const {
    double pace = slowest_ > 0 ? slowest_ : known_;
    if (known_ > 0) pace = std::min(pace, known_);
    double groups = pace > 0 ? pace * (known_ > 0 ? kPieceMs : kFirstPieceMs) : 4e9;
    if (known_ <= 0) groups = std::min(groups, double(last_ > 0 ? last_ * double(kGrowth) : kFirstGroups));
    const auto count = std::clamp(static_cast<unsigned>(std::min(groups, 4e9)), 1u, std::min(left, most));
    const unsigned rest = left - count;
    return known_ > 0 && rest < count / 2 && count + rest <= most ? left : count;  // no small rest
}

void Pace::took(unsigned groups, double ms) {
    const double at_least = std::max(ms, 1e-3);
    // The very first launch may include a compilation, so its time is not used. If it was long, the next piece has the smallest
    // size.
    const bool first = known_ <= 0 && pieces_++ == 0;
    last_ = first && ms > kFirstPieceMs ? 1 : groups;
    if (first) return;
    all_groups_ += groups;
    all_ms_ += at_least;
    if (ms > kTellingMs) slowest_ = slowest_ > 0 ? std::min(slowest_, groups / at_least) : groups / at_least;
}

double Pace::expected_ms(unsigned groups) const {
    return known_ > 0 ? groups / known_ : std::numeric_limits<double>::infinity();
}

void Pace::end_picture() {
    if (slowest_ > 0)
        known_ = slowest_;
    else if (all_ms_ > 0)
        known_ = all_groups_ / all_ms_;
}

}  // namespace clarity
