// picture_goal.hpp -- when a picture has samples enough: --error, --time-budget, --adaptive.
#pragma once
#include <chrono>

#include "cli/commands.hpp"
#include "picture/film_noise.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

class MultiFrameRenderer;
class Ranks;

// Whether a picture ends by its error or its time. Without --spp it then has as many samples as that takes.
bool has_goal(const RenderOptions& options);
// The same, or when all of its pixels have samples enough.
bool ends_by_itself(const RenderOptions& options, const Settings& settings);
bool states_samples(const RenderOptions& options);

// Used from one thread.
class PictureGoal {
 public:
    // The references must outlive it.
    PictureGoal(const RenderOptions& options, const Settings& settings, Ranks* ranks)
        : settings_(settings), error_(options.error), budget_s_(options.time_budget_s), ranks_(ranks) {}

    // Begins a picture that has `first` samples.
    void begin(unsigned first);
    // How many samples may follow at most, after `samples`, before it is asked again. 0: they are enough. All ranks call it.
    unsigned more(MultiFrameRenderer& frames, unsigned samples);

 private:
    unsigned more_for_error(MultiFrameRenderer& frames, unsigned samples);
    unsigned more_for_pixels(MultiFrameRenderer& frames, unsigned samples) const;
    unsigned more_in_time(unsigned samples) const;

    const Settings& settings_;
    const double error_, budget_s_;
    Ranks* const ranks_;
    std::chrono::steady_clock::time_point begin_;
    unsigned first_ = 0, next_ = 0;  // samples at begin(); samples at which the error is estimated again
};

}  // namespace clarity
