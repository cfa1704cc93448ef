#include "ui/threads/convergence.hpp"

#include <cmath>

#include "render/compare/picture_errors.hpp"

namespace clarity::ui {

bool Convergence::add(unsigned sample, double ms) {
    if (sample == 0) *this = {};
    seconds_ += ms / 1000;
    // 2, 3, 4, 6, 8, 12, ...
    unsigned samples = sample + 1;
    while (samples % 2 == 0 && samples > 2) samples /= 2;
    return samples == 2 || samples == 3;
}

void Convergence::put(const FilmNoise& noise, double rmse) {
    // Neither has a logarithm.
    const bool known = !points_.empty() && points_.back().samples == noise.mean_samples;
    if (noise.error > 0 && std::isfinite(noise.error) && !known)
        points_.push_back({noise.mean_samples, seconds_, noise.error, rmse});
}

double Convergence::slope() const {
    std::vector<std::pair<unsigned, double>> errors;
    for (const Point& point : points_) errors.emplace_back(unsigned(std::lround(point.samples)), point.error);
    return error_slope(errors);
}

}  // namespace clarity::ui
