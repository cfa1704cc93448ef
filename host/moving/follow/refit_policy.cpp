#include "moving/follow/refit_policy.hpp"

#include <algorithm>

namespace clarity {
namespace {

// Found by trying 720 combinations on the motions of the test; neighbours do nearly as well.
constexpr double kStep = 1.5, kMostPatience = 64;
constexpr double kPays = 0.3;      // a build pays if the frames after it gain this share of its cost
constexpr double kReturned = 0.7;  // a loss below this share of the greatest: the motion returns
constexpr double kReturning = 5;   // times the debt, for such motions
constexpr double kFalling = 3;     // times the debt, while the loss falls

}  // namespace

double RefitPolicy::limit_ms() const {
    return patience_ * build_ms_ * (has_returned_ ? kReturning : 1);
}

bool RefitPolicy::wants_build() const {
    if (!(build_ms_ > 0) || debt_ms_ < limit_ms()) return false;
    return loss_ms_ >= greatest_loss_ms_ || debt_ms_ >= kFalling * limit_ms();
}

void RefitPolicy::built(double build_ms) {
    if (has_followed_)
        patience_ =
            gained_ms_ < kPays * build_ms_ ? std::min(kStep * patience_, kMostPatience) : std::max(1.0, patience_ / kStep);
    has_followed_ = build_ms_ > 0;
    loss_before_ms_ = loss_ms_;
    build_ms_ = std::max(build_ms, 1e-3);
    debt_ms_ = loss_ms_ = greatest_loss_ms_ = gained_ms_ = 0;
    has_returned_ = false;
}

void RefitPolicy::refitted(double cost_ratio, double trace_ms) {
    loss_ms_ = cost_ratio > 1 ? trace_ms * (1 - 1 / cost_ratio) : 0;
    greatest_loss_ms_ = std::max(greatest_loss_ms_, loss_ms_);
    debt_ms_ += loss_ms_;
    gained_ms_ += loss_before_ms_ - loss_ms_;
    has_returned_ = has_returned_ || loss_ms_ < kReturned * greatest_loss_ms_;
}

}  // namespace clarity
