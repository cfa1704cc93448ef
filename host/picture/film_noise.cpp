#include "picture/film_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/parallel_for.hpp"
#include "base/pictures/srgb.hpp"
#include "rt_types.h"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

constexpr unsigned kFirstLook = 32;
constexpr int kAround = 2;  // pixels on each side

// The first two planes of a film.
struct Film {
    explicit Film(const FloatImage& sums, unsigned planes = 2)
        : width(sums.width),
          height(sums.height / planes),
          light(sums.pixels.data()),
          rest(light + RT_PLANE_REST * size_t(width) * height * 4) {}
    size_t width, height;
    const float *light, *rest;

    double count(size_t i) const { return light[4 * i + 3]; }
    double luminance(size_t i) const { return luminance_of(light + 4 * i) / count(i); }
    // Of a sample's luminance. The sign says whether the pixel rests.
    double variance(size_t i) const { return std::fabs(rest[4 * i + 3]) / (count(i) - 1); }
    bool finite(size_t i) const { return std::isfinite(luminance(i)) && std::isfinite(rest[4 * i + 3]); }

    // The sum of `of` over the finite pixels, row by row, so that it does not depend on threads.
    template <typename Of>
    double sum(const Of& of) const {
        std::vector<double> rows(height);
        parallel_for(uint32_t(height), [&](uint32_t y) {
            for (size_t i = y * width; i < (y + 1) * width; ++i)
                if (finite(i)) rows[y] += of(i);
        });
        return std::accumulate(rows.begin(), rows.end(), 0.0);
    }
};

// A mean that some pixels take no part in.
struct Part {
    double sum = 0;
    int count = 0;
    void add(const Part& more) { sum += more.sum, count += more.count; }
    double mean() const { return count > 0 ? sum / count : 0; }
};

// Calls use(at) for each place within kAround of `middle`, and below `end`.
template <typename Use>
void around(int middle, int end, const Use& use) {
    for (int at = std::max(0, middle - kAround); at <= std::min(end - 1, middle + kAround); ++at) use(size_t(at));
}

// Which pixel of 4x4 has its turn, in the order of looks: 7 is odd, so that all of them have one, and neighbours not in a row.
unsigned turn_of_look(unsigned samples) {
    unsigned looks = 0;
    for (unsigned look = kFirstLook; look < samples; look = next_look(look)) ++looks;
    return 7 * looks % 16;
}

}  // namespace

FilmNoise film_noise(const FloatImage& sums) {
    const Film film(sums);
    const size_t pixels = film.width * film.height;
    FilmNoise noise;
    double least = INFINITY;
    for (size_t i = 0; i < pixels; ++i) {
        least = std::min(least, film.count(i));
        noise.mean_samples += film.count(i);
    }
    noise.mean_samples /= double(pixels);
    if (least < 2) {
        noise.error = INFINITY;
        return noise;
    }
    const double squares = film.sum([&](size_t i) { return film.variance(i) / film.count(i); });
    const double light = film.sum([&](size_t i) { return film.luminance(i); });
    if (squares > 0) noise.error = std::sqrt(squares * film.sum([](size_t) { return 1.0; })) / light;
    return noise;
}

unsigned next_look(unsigned samples) {
    if (samples < kFirstLook) return kFirstLook;
    unsigned power = kFirstLook;
    while (power <= samples / 2) power *= 2;
    return samples < power + power / 2 ? power + power / 2 : 2 * power;
}

bool is_look(unsigned samples) {
    return samples > 0 && next_look(samples - 1) == samples;
}

bool is_resting(float deviations) {
    return std::signbit(deviations) && !std::isnan(deviations);
}

double adaptive_bound(const Settings& settings) {
    const bool may_rest = find_setting("adaptive")->used(settings) && find_aov(settings.aov).adds_samples();
    return may_rest ? number_of(settings, "adaptive") : 0;
}

uint64_t mark_resting(FloatImage& sums, double bound, unsigned samples, unsigned planes) {
    const Film film(sums, planes);
    const int width = int(film.width), height = int(film.height);
    const double pixels = film.sum([](size_t) { return 1.0; });
    const double mean_variance = film.sum([&](size_t i) { return film.variance(i); }) / std::max(pixels, 1.0);
    const double mean_light = film.sum([&](size_t i) { return film.luminance(i); }) / std::max(pixels, 1.0);
    std::vector<Part> across(film.width * film.height);  // variances of the row's pixels around each
    parallel_for(uint32_t(height), [&](uint32_t y) {
        for (int x = 0; x < width; ++x)
            around(x, width, [&](size_t at) {
                if (film.finite(y * film.width + at)) across[y * film.width + x].add({film.variance(y * film.width + at), 1});
            });
    });
    const unsigned turn = turn_of_look(samples);
    float* const rest = sums.pixels.data() + film.width * film.height * 4;
    std::vector<uint64_t> noisy(film.height);
    parallel_for(uint32_t(height), [&](uint32_t y) {
        for (int x = 0; x < width; ++x) {
            const size_t i = y * film.width + x;
            Part near;
            around(int(y), height, [&](size_t at) { near.add(across[at * film.width + x]); });
            const double variance = std::max(film.variance(i), near.mean()) + mean_variance / film.count(i);
            const double allowed = bound * std::max(film.luminance(i), mean_light);
            // Of a picture that is black so far nothing is known.
            const bool is_noisy = film.finite(i) && (!(mean_light > 0) || variance / film.count(i) > allowed * allowed);
            noisy[y] += is_noisy;
            const bool rests = !is_noisy && (unsigned(x) % 4 + 4 * (y % 4)) != turn;
            rest[4 * i + 3] = std::copysign(rest[4 * i + 3], rests ? -1.0f : 1.0f);
        }
    });
    return std::accumulate(noisy.begin(), noisy.end(), uint64_t(0));
}

}  // namespace clarity
