// sampler_points.hpp -- the random numbers of a pixel's samples, by their dimensions (cl/sampling/dimensions.h).
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace clarity {

struct SamplerPoints {
    unsigned samples = 0, dimensions = 0;
    std::vector<float> values;  // of 0..1, those of a sample together
    float at(unsigned sample, unsigned dimension) const { return values[size_t(sample) * dimensions + dimension]; }
};

// What a dimension is for, by its number: "pixel x", "event 2, light u".
std::string dimension_name(unsigned dimension);

// A grid of as many cells as there are samples, or fewer: columns and rows are powers of two. The first two dimensions of a set
// of Sobol's points have one point in each, if their number is a power of two.
struct Strata {
    unsigned columns = 1, rows = 1;
    unsigned filled = 0;  // cells with a point in them
};
Strata strata_of(const SamplerPoints& points, unsigned across, unsigned up);

// All of it as text: a line of names, then one for each sample.
std::string points_csv(const SamplerPoints& points);

}  // namespace clarity
