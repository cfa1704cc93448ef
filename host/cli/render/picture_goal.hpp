// picture_goal.hpp -- when a picture has samples enough: --error and --time-budget.
#pragma once
#include <chrono>

#include "base/pictures/float_image.hpp"
#include "cli/commands.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

class MultiFrameRenderer;
class Ranks;

// The estimated error of a picture of `path`: the root of the mean over pixels of the squared standard error of their
// luminance, by the mean luminance. It is that of independent samples; Sobol's points do better. sums: of film_planes() 2, as
// MultiFrameRenderer::read_sums() gives them. Infinite for fewer than two samples, and of a black picture 0.
double estimated_error(const FloatImage& sums);

// Whether a picture ends by its error or its time. Without --spp it then has as many samples as that takes.
bool has_goal(const RenderOptions& options);
bool states_samples(const RenderOptions& options);

class PictureGoal {
 public:
    PictureGoal(const RenderOptions& options, Ranks* ranks)
        : error_(options.error), budget_s_(options.time_budget_s), ranks_(ranks) {}

    // Begins a picture that has `first` samples.
    void begin(unsigned first);
    // How many samples may follow at most, after `samples`, before it is asked again. 0: they are enough. All ranks call it.
    unsigned more(MultiFrameRenderer& frames, unsigned samples);
    // Estimated, when it was last asked for; negative: never.
    double reached() const { return reached_; }

 private:
    unsigned more_for_error(MultiFrameRenderer& frames, unsigned samples);
    unsigned more_in_time(unsigned samples) const;

    const double error_, budget_s_;
    Ranks* const ranks_;
    std::chrono::steady_clock::time_point begin_;
    unsigned first_ = 0, next_ = 0;  // samples at begin(); samples at which the error is estimated again
    double reached_ = -1;
};

}  // namespace clarity
