// noise.hpp -- why a pixel of the tracer `path` is noisy: of which parts of its light the variance of its samples consists.
//
// All is about luminance. The light of a sample is the sum of the light of its path's records. The share of a part is its
// covariance with the sum, by the variance of the sum: shares of parts that make up the sum add up to 1, and a part that is
// small where the others are large has a share below 0.
#pragma once
#include <string>
#include <vector>

#include "base/pictures/srgb.hpp"
#include "tracers/replay/replay.hpp"

namespace clarity {

struct NoiseShare {
    std::string name;
    double of_variance = 0, of_light = 0;
};

// The samples with a luminance in [from, to).
struct NoiseBin {
    double from = 0, to = 0;
    unsigned samples = 0;
    double of_variance = 0;  // their squared deviations from the mean, by those of all
};

enum class NoiseCause { black, quiet, not_finite, lamp, caustic, lobe, lights, deep, edge, mixed };
const char* name_of(NoiseCause cause);

struct NoiseReport {
    unsigned samples = 0, not_finite = 0;                     // the latter count in no figure
    std::array<float, 3> mean{};                              // as the film has it
    double luminance = 0;                                     // of the mean
    double variance = 0;                                      // of a sample
    double error() const;                                     // standard error of the mean, of independent samples
    std::vector<NoiseBin> histogram;                          // of black samples; then bins, each twice as wide as the last
    std::vector<NoiseShare> by_bounce, by_lobe, by_strategy;  // by their numbers
    std::vector<NoiseShare> by_light;                         // the largest share first
    std::vector<unsigned> brightest;                          // numbers of samples, the brightest first, ten at most
    NoiseCause cause = NoiseCause::quiet;
    double cause_share = 0;  // of the variance
    std::string sentence;    // names the cause, and what to try
};

// What the report calls things, and what it advises.
struct NoiseNames {
    std::vector<std::string> lights;  // of the view, by their numbers
    std::string strategy = "mis";     // Settings::strategy
};
NoiseNames noise_names(const Scene& scene, const View& view, const Settings& settings);
// "lamp `bulb`", "the sky", "glowing surfaces".
std::string light_title(const NoiseNames& names, int light_number);
// "diffuse", "drawn (nee)"...
const char* lobe_name(rt_u32 first);
const char* strategy_name(rt_u32 by);

// The light that brought most of a sample; nullptr: none did.
const rt_path_record* brightest_record(const Replay& replay, const ReplayedSample& sample);

NoiseReport noise_report(const Replay& replay, const NoiseNames& names);

// Of some samples, a line for each record of their paths, after a line with the names of the columns.
std::string paths_csv(const Replay& replay, const std::vector<unsigned>& samples, const NoiseNames& names, const Scene& scene);

// For noise_report().

// Of each sample the sum over its records; and whether it is finite.
struct NoiseValues {
    std::vector<double> luminance, deviation;  // from the mean; 0 of samples that are not finite
    double mean = 0, squares = 0;              // the sum of squared deviations
    unsigned finite = 0;
};
// Sets cause, cause_share and sentence.
void find_cause(const Replay& replay, const NoiseValues& values, const NoiseNames& names, NoiseReport& report);

}  // namespace clarity
