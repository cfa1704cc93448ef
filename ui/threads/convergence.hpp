// convergence.hpp -- how the estimated error of a picture of `path` has fallen while its samples were traced.
#pragma once
#include <vector>

#include "render/film/film_noise.hpp"

namespace clarity::ui {

class Convergence {
 public:
    struct Point {
        double samples;  // a pixel, the mean
        double seconds;  // of tracing
        double error;    // FilmNoise::error
        double rmse;     // against the reference; NaN: there is none of this size
    };
    // A sample more was traced, in so many milliseconds; sample 0 begins anew. Returns whether the error is to be estimated
    // now: of some samples only, as the film must be read for it.
    bool add(unsigned sample, double ms);
    // Estimated after the last sample. More than once does no harm.
    void put(const FilmNoise& noise, double rmse);
    double seconds() const { return seconds_; }  // of all samples
    const std::vector<Point>& points() const { return points_; }
    // The exponent of the samples by which the error falls; NaN: not known.
    double slope() const;

 private:
    std::vector<Point> points_;
    double seconds_ = 0;
};

}  // namespace clarity::ui
