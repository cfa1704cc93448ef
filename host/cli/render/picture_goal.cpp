#include "cli/render/picture_goal.hpp"

#include <algorithm>
#include <cmath>

#include "base/elapsed.hpp"
#include "render/multi/multi_frame_renderer.hpp"

namespace clarity {
namespace {

// Of fewer samples nobody knows the variance.
constexpr unsigned kFewest = 16;
constexpr unsigned kUnlimited = 1u << 30;

}  // namespace

double estimated_error(const FloatImage& sums) {
    const size_t pixels = sums.pixels.size() / 8;  // two planes of four channels
    const float* const sum = sums.pixels.data();
    const float* const rest = sum + 4 * pixels;
    double squares = 0, light = 0;
    for (size_t i = 0; i < pixels; ++i) {
        const double count = sum[4 * i + 3];
        if (count < 2) return INFINITY;
        squares += rest[4 * i + 3] / ((count - 1) * count);
        light += (0.2126 * sum[4 * i] + 0.7152 * sum[4 * i + 1] + 0.0722 * sum[4 * i + 2]) / count;
    }
    if (squares == 0) return 0;
    return std::sqrt(squares * double(pixels)) / light;
}

bool has_goal(const RenderOptions& options) {
    return options.error > 0 || options.time_budget_s > 0;
}

bool states_samples(const RenderOptions& options) {
    const auto of_table = [](const auto& pair) { return pair.first == "spp"; };
    const auto of_set = [](const std::string& text) { return text.rfind("spp=", 0) == 0; };
    const TraceOptions& trace = options.trace;
    return std::any_of(trace.settings.begin(), trace.settings.end(), of_table) ||
           std::any_of(trace.sets.begin(), trace.sets.end(), of_set);
}

void PictureGoal::begin(unsigned first) {
    begin_ = std::chrono::steady_clock::now();
    first_ = first;
    next_ = std::max(kFewest, first);
    reached_ = -1;
}

unsigned PictureGoal::more(MultiFrameRenderer& frames, unsigned samples) {
    const unsigned in_time = more_in_time(samples);
    // Ranks differ in time and agree in the error: the first one's word counts.
    const double time = ranks_ ? ranks_->gather(in_time)[0] : in_time;
    return time == 0 ? 0 : std::min(unsigned(time), more_for_error(frames, samples));
}

unsigned PictureGoal::more_in_time(unsigned samples) const {
    if (budget_s_ == 0) return kUnlimited;
    const double spent_s = seconds_since(begin_), left_s = budget_s_ - spent_s;
    if (left_s <= 0) return 0;
    const double each_s = spent_s / std::max(samples - first_, 1u);
    return left_s < 0.5 * each_s ? 0 : unsigned(std::clamp(left_s / each_s, 1.0, double(kUnlimited)));
}

unsigned PictureGoal::more_for_error(MultiFrameRenderer& frames, unsigned samples) {
    if (error_ == 0) return kUnlimited;
    if (samples >= next_) {
        reached_ = estimated_error(frames.read_sums());
        if (ranks_) reached_ = ranks_->gather(reached_)[0];  // only the first one has all pixels
        if (reached_ <= error_) return 0;
        // Errors of independent samples fall with the root of their number.
        const double wanted = samples * std::pow(reached_ / error_, 2);
        next_ = unsigned(std::clamp(wanted, samples + 1.0, 2.0 * samples));
    }
    return next_ - samples;
}

}  // namespace clarity
