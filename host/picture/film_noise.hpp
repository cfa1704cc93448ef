// film_noise.hpp -- what the film of `path` knows of its own noise: how large the error of a picture is, and which of its
// pixels have samples enough (adaptive sampling). Images are those of FrameRenderer::read_sums(), of two planes:
// cl/tracers/path/sum.h.
#pragma once
#include <cstdint>

#include "base/pictures/float_image.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

struct FilmNoise {
    // The root of the mean over pixels of the squared standard error of their luminance, by the mean luminance. It is that of
    // independent samples; Sobol's points do better. Infinite for fewer than two samples, and of a black picture 0. Pixels that
    // are no number are left out: more samples do not mend them.
    double error = 0;
    double mean_samples = 0;  // over pixels
};
FilmNoise film_noise(const FloatImage& sums);

// Adaptive sampling looks at the film at these numbers of samples: 32, 48, 64, 96, 128, 192, ... Between two of them are 2^n
// samples from a multiple of 2^n on, which Sobol's points spread evenly by themselves.
unsigned next_look(unsigned samples);  // the first one after `samples`
bool is_look(unsigned samples);

// Says which pixels rest until the next look, by the sign of their sum of squared deviations: a pixel rests if its standard
// error is at most `bound` times its light, or, where that is more, the mean light of the picture. Returns how many pixels have
// a larger error.
//
// The variance of a pixel is taken to be at least the mean of those of the 5x5 pixels around it, and a further sample is
// assumed, of the mean variance of all pixels. So a pixel that was black in all samples rests only after enough of them, and
// few pixels rest because their variance is small by chance. One pixel of each 4x4 never rests until the next look, each in its
// turn: what it finds wakes its neighbours.
// planes: of the film, of which the first two count.
uint64_t mark_resting(FloatImage& sums, double bound, unsigned samples, unsigned planes = 2);
// Whether the mark says so. deviations: the pixel's sum of squared deviations.
bool is_resting(float deviations);

// The setting `adaptive`; 0 for pictures in which no pixel may rest.
double adaptive_bound(const Settings& settings);

}  // namespace clarity
