#include "cli/render/picture_goal.hpp"

#include <algorithm>
#include <cmath>

#include "base/elapsed.hpp"
#include "picture/film_noise.hpp"
#include "stand/multi_frame_renderer.hpp"

namespace clarity {
namespace {

// Of fewer samples nobody knows the variance.
constexpr unsigned kFewest = 16;
constexpr unsigned kUnlimited = 1u << 30;

}  // namespace

bool has_goal(const RenderOptions& options) {
    return options.error > 0 || options.time_budget_s > 0;
}

bool ends_by_itself(const RenderOptions& options, const Settings& settings) {
    return has_goal(options) || adaptive_bound(settings) > 0;
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
}

unsigned PictureGoal::more(MultiFrameRenderer& frames, unsigned samples) {
    const unsigned in_time = more_in_time(samples);
    // Ranks differ in time and agree in the error: the first one's word counts.
    const double time = ranks_ ? ranks_->gather(in_time)[0] : in_time;
    return time == 0 ? 0 : std::min({unsigned(time), more_for_error(frames, samples), more_for_pixels(frames, samples)});
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
        double reached = frames.noise().error;
        if (ranks_) reached = ranks_->gather(reached)[0];  // only the first one has all pixels
        if (reached <= error_) return 0;
        // Errors of independent samples fall with the root of their number.
        const double wanted = samples * std::pow(reached / error_, 2);
        next_ = unsigned(std::clamp(wanted, samples + 1.0, 2.0 * samples));
    }
    return next_ - samples;
}

// Until all pixels would rest.
unsigned PictureGoal::more_for_pixels(MultiFrameRenderer& frames, unsigned samples) const {
    if (!(adaptive_bound(settings_) > 0)) return kUnlimited;
    if (is_look(samples) && frames.look(settings_, samples) == 0) return 0;
    return next_look(samples) - samples;
}

}  // namespace clarity
