// path_pictures_test.cpp -- pictures by `path` against those of another renderer, which are shared and not part of the
// repository.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/pictures/picture_read.hpp"
#include "images/path_checks.hpp"
#include "images/path_scenes.hpp"
#include "scene/vec.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kSize = 256, kBlock = 8, kBlocks = kSize / kBlock;

double luminance(const FloatImage& image, size_t pixel) {
    const float* const c = &image.pixels[3 * pixel];
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

// Without the worst 0.1 %, which are edges of the lamp.
double root_mean_square(const FloatPixels& values) {
    std::vector<double> squares;
    for (const float v : values) squares.push_back(double(v) * v);
    std::sort(squares.begin(), squares.end());
    squares.resize(squares.size() - squares.size() / 1000);
    return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / double(squares.size()));
}

// The values of the 64 pixels of a block.
template <class Of>
std::vector<double> of_block(unsigned block, Of&& of) {
    std::vector<double> values;
    for (unsigned y = 0; y < kBlock; ++y)
        for (unsigned x = 0; x < kBlock; ++x)
            values.push_back(of((block / kBlocks * kBlock + y) * kSize + block % kBlocks * kBlock + x));
    return values;
}
double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / double(values.size());
}
// The median of a block and its standard error, by the ranks that are 4, half of the root of 64, below and above it.
struct Median {
    double value, error;
};
Median median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return {0.5 * (values[31] + values[32]), 0.5 * (values[36] - values[27])};
}

// Whether a block shows one of the three roughest metals of the spheres. The reference is 7 % too dark there on the average:
// with light sampling off, the renderer that made it gives 1.361 1.302 1.224 for a square of 4 degrees on the middle of the
// roughest ball, and with it 1.265 1.214 1.153 (RoughMetal below). Of our own, nee, bsdf and mis agree.
bool shows_rough_metal(const View& view, unsigned block) {
    const Vec eye = to_vec(view.camera.eye), w = normalized(to_vec(view.camera.target) - eye);
    const Vec u = normalized(cross(w, to_vec(view.camera.up))), v = cross(u, w);
    const double tangent = std::tan(0.5 * view.camera.fov_y_rad);
    for (const double value : of_block(block, [&](size_t i) {
             const double right = (2 * (double(i % kSize) + 0.5) / kSize - 1) * tangent,
                          up = (1 - 2 * (std::floor(double(i) / kSize) + 0.5) / kSize) * tangent;
             const Vec d = normalized(w + right * u + up * v);
             for (const double x : {0.0, 1.1, 2.2}) {
                 const Vec to = Vec{x, 0.5, -0.7} - eye;
                 if (length(to - dot(to, d) * d) < 0.51) return 1.0;
             }
             return 0.0;
         }))
        if (value > 0) return true;
    return false;
}

struct Pair {
    PathPicture ours;
    FloatImage reference;
};
Pair traced(const ScenePtr& scene, const std::string& reference, unsigned samples, const char* sampler) {
    Pair pair{trace_paths(*scene, make_view(*scene, 1), samples,
                          {{"size", "256x256"}, {"depth", "65"}, {"sampler", sampler}, {"lanes", "16"}, {"accel", "bvh8"}}),
              read_picture(reference)};
    EXPECT_EQ(pair.reference.width, kSize);
    return pair;
}

}  // namespace

// The noise of the reference is known as a whole: an RMSE of 0.0012. It is shared out among pixels as ours is.
TEST(PathPictures, CornellBox) {
    CLARITY_SHARED_OR_SKIP(reference, "light/ref/cornell.pfm");
    const Pair pair = traced(cornell_box(), reference, 256, "independent");
    const FloatImage &ours = pair.ours.mean, &theirs = pair.reference;
    for (size_t c = 0; c < 3; ++c) {
        double sum = 0, sum_theirs = 0;
        for (size_t i = c; i < ours.pixels.size(); i += 3) sum += ours.pixels[i], sum_theirs += theirs.pixels[i];
        EXPECT_NEAR(sum / sum_theirs, 1, 0.001) << "channel " << c;
        std::printf("channel %zu: mean ratio %.5f\n", c, sum / sum_theirs);
    }
    const double share = 0.0012 / root_mean_square(pair.ours.error.pixels);
    unsigned beyond = 0;
    double squares = 0;
    for (unsigned block = 0; block < kBlocks * kBlocks; ++block) {
        const double off = mean_of(of_block(block, [&](size_t i) { return luminance(ours, i) - luminance(theirs, i); }));
        const double variance = mean_of(of_block(block, [&](size_t i) {
            const double e = pair.ours.error.pixels[i];
            return e * e * (1 + share * share);
        }));
        const double z = off / std::sqrt(variance / (kBlock * kBlock));
        beyond += std::fabs(z) > 4;
        if (std::fabs(z) > 4) std::printf("block %u,%u: off %g, z %g\n", block % kBlocks, block / kBlocks, off, z);
        squares += z * z;
    }
    EXPECT_LE(beyond, kBlocks * kBlocks / 1000);
    const double deviation = std::sqrt(squares / (kBlocks * kBlocks));
    EXPECT_GT(deviation, 0.85);
    EXPECT_LT(deviation, 1.15);
    std::printf("%u blocks beyond 4 standard errors, deviation of z %.3f\n", beyond, deviation);
}

// Caustics make the mean noisy, so medians are compared.
TEST(PathPictures, SpheresUnderASky) {
    CLARITY_SHARED_OR_SKIP(reference, "light/ref/spheres_multiggx.pfm");
    const ScenePtr scene = spheres_under_sky();
    const Pair pair = traced(scene, reference, 512, "sobol");
    unsigned compared = 0, beyond = 0, one_percent = 0;
    for (unsigned block = 0; block < kBlocks * kBlocks; ++block) {
        if (shows_rough_metal(make_view(*scene, 1), block)) continue;
        const Median mine = median_of(of_block(block, [&](size_t i) { return luminance(pair.ours.mean, i); }));
        const Median theirs = median_of(of_block(block, [&](size_t i) { return luminance(pair.reference, i); }));
        const bool is_near = std::fabs(mine.value / theirs.value - 1) <= 0.01;
        ++compared, one_percent += is_near;
        if (is_near || std::fabs(mine.value - theirs.value) <= 4 * std::hypot(mine.error, theirs.error)) continue;
        ++beyond;
        std::printf("block %u,%u: %g +- %g, %g +- %g\n", block % kBlocks, block / kBlocks, mine.value, mine.error, theirs.value,
                    theirs.error);
    }
    std::printf("%u of %u blocks beyond, %u within 1 %%\n", beyond, compared, one_percent);
    EXPECT_GT(compared, 900u);
    EXPECT_LE(beyond, compared / 100);
}

// The roughest ball by itself: a random walk between facets (Heitz, Hanika, d'Eon, Dachsbacher 2016) in another renderer, whose
// rays find the sky by chance. Our lobe of several facets is that of Kulla and Conty, which has its energy but not quite its
// shape.
TEST(PathPictures, RoughMetal) {
    CLARITY_SHARED_OR_SKIP(reference, "light/ref/spheres_multiggx.pfm");
    const ScenePtr scene = spheres_under_sky();
    const View view = make_view(*scene, 1, "0,2.4,6,2.2,0.5,-0.7,4");
    const double walked[] = {1.3614, 1.3015, 1.2244};
    for (const char* strategy : {"mis", "bsdf"}) {
        const FloatImage image =
            trace_paths(*scene, view, 1024, {{"size", "16x16"}, {"depth", "65"}, {"lanes", "16"}, {"strategy", strategy}}).mean;
        for (size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (size_t i = c; i < image.pixels.size(); i += 3) sum += image.pixels[i];
            EXPECT_NEAR(sum / 256 / walked[c], 1, 0.02) << strategy << ", channel " << c;
            std::printf("%s %g\n", strategy, sum / 256);
        }
    }
}
