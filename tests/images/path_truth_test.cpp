// path_truth_test.cpp -- the whole program meets the closed forms of light, by every strategy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "images/path_checks.hpp"
#include "reference/closed_forms.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;
using reference::ClosedForm;

namespace {

struct Mean {
    double value[3] = {}, variance[3] = {};  // of the value
    double error(size_t c) const { return std::sqrt(variance[c]); }
};

// The mean of a picture, and its standard error: by the spread of pixels that expect the same light, else by that of their
// samples, whose luminance it is taken from.
Mean mean_of(const ClosedForm& form, unsigned samples, const char* strategy, int seed) {
    Pairs settings = {{"depth", std::to_string(form.depth)},
                      {"size", "32x32"},
                      {"sampler", "independent"},
                      {"strategy", strategy},
                      {"seed", std::to_string(seed)}};
    if (form.bounce >= 0) settings.emplace_back("only_bounce", std::to_string(form.bounce));
    const PathPicture picture = trace_paths(form.scene, form.view, samples, settings);
    const auto& pixels = picture.mean.pixels;
    Mean mean;
    const double n = double(pixels.size() / 3);
    for (size_t c = 0; c < 3; ++c) {
        double squares = 0;
        for (size_t i = c; i < pixels.size(); i += 3) {
            mean.value[c] += double(pixels[i]) / n;
            squares += double(pixels[i]) * pixels[i] / n;
        }
        mean.variance[c] = std::max(0.0, squares - mean.value[c] * mean.value[c]) / (n - 1);
        if (!form.varies) continue;
        mean.variance[c] = 0;
        for (const float e : picture.error.pixels) mean.variance[c] += double(e) * e / (n * n);
    }
    return mean;
}

// Floats of sums and weights: 2e-5 of the value.
bool meets(const ClosedForm& form, const Mean& mean) {
    for (size_t c = 0; c < 3; ++c)
        if (!(std::fabs(mean.value[c] - form.expected[c]) <= 4 * mean.error(c) + form.rounding + 2e-5 * form.expected[c]))
            return false;
    return true;
}

// How far a mean is off, of the largest value that is expected beside it.
double share_off(const ClosedForm& form, const Mean& mean) {
    double worst = 0;
    for (size_t c = 0; c < 3; ++c) worst = std::max(worst, std::fabs(mean.value[c] - form.expected[c]));
    return std::max(0.0, worst - form.rounding) / form.largest;
}

// Traces until the error is small enough to tell 0.2 % of the largest value.
Mean precise_mean(const ClosedForm& form, int seed) {
    Mean sum;
    for (int pictures = 1;; ++pictures) {
        const Mean one = mean_of(form, 256, "mis", 100 * seed + pictures);
        Mean mean;
        for (size_t c = 0; c < 3; ++c) {
            sum.value[c] += one.value[c], sum.variance[c] += one.variance[c];
            mean.value[c] = sum.value[c] / pictures, mean.variance[c] = sum.variance[c] / pictures / pictures;
        }
        if (4 * std::max({mean.error(0), mean.error(1), mean.error(2)}) < 0.002 * form.largest || pictures == 32) return mean;
    }
}

bool begins(const std::string& text, const char* with) {
    return text.rfind(with, 0) == 0;
}

// Fixed seeds; a failure is repeated with another one. bound: the most that the standard error may be of the value, so that the
// test tells something.
void expect_truth(const ClosedForm& form, unsigned samples, const char* strategy, double bound) {
    const bool precise = !quick() && strategy == std::string("mis");
    Mean mean = precise ? precise_mean(form, 1) : mean_of(form, samples, strategy, 1);
    if (!meets(form, mean) || (precise && share_off(form, mean) > 0.002))
        mean = precise ? precise_mean(form, 2) : mean_of(form, samples, strategy, 2);
    if (precise) {
        EXPECT_LE(share_off(form, mean), 0.002) << form.name << ": " << mean.value[0] << " of " << form.expected[0];
    }
    EXPECT_TRUE(meets(form, mean)) << form.name << " by " << strategy << ": " << mean.value[0] << " " << mean.value[1] << " "
                                   << mean.value[2] << " +- " << mean.error(0) << " instead of " << form.expected[0] << " "
                                   << form.expected[1] << " " << form.expected[2];
    EXPECT_LE(mean.error(0), bound * (form.expected[0] + 0.005))
        << form.name << " by " << strategy << ": the bound tells nothing";
}

}  // namespace

class PathTruth : public testing::TestWithParam<const char*> {};

TEST_P(PathTruth, IsMet) {
    size_t met = 0;
    for (const ClosedForm& form : reference::closed_forms())
        if (form.group == GetParam()) expect_truth(form, quick() ? 64 : 1024, "mis", 0.02), ++met;
    EXPECT_GT(met, 4u);
}

TEST_P(PathTruth, IsMetByOtherStrategies) {
    if (GetParam() == std::string("glass")) GTEST_SKIP() << "smooth glass leaves no choice";
    for (const ClosedForm& form : reference::closed_forms())
        for (const char* strategy : {"bsdf", "nee"})
            if (form.group == GetParam() &&
                (begins(form.name, "under") || begins(form.name, "room") || begins(form.name, "furnace") ||
                 begins(form.name, "ball") || begins(form.name, "Lambert")))
                expect_truth(form, quick() ? 64 : 1024, strategy, 0.08);
}

INSTANTIATE_TEST_SUITE_P(, PathTruth, testing::Values("furnaces", "lights", "skies", "rooms", "glass"),
                         [](const auto& info) { return std::string(info.param); });

// Faults of surfaces, each planted into the text of a kernel.
const PlantedFault kTruthFaults[] = {
    {"density off by 2", "shading/bsdf.h", "*pdf = rt_select(above, p.diffuse * cosine, zero);",
     "*pdf = rt_select(above, rt_vfloat(2.0f) * p.diffuse * cosine, zero);", "PathTruth.IsMet/rooms"},
    {"normals of the wrong side", "shading/point.h", "const vfloat side = rt_select(p.leaving, -one, one);",
     "const vfloat side = one;", "PathTruth.IsMet/furnaces"},
    {"eta^2 missing", "shading/bsdf.h", "bent_share = glass_share / (b->eta * b->eta)", "bent_share = glass_share",
     "PathTruth.IsMet/glass"},
    {"roughness squared twice", "shading/bsdf_of.h", "alpha = m->roughness * m->roughness;",
     "alpha = m->roughness * m->roughness * m->roughness * m->roughness;", "PathTruth.IsMet/furnaces"},
    {"no Beer-Lambert", "tracers/path/scatter.h", "const vfloat way = -rt_min(distance, rt_vfloat(1e30f));",
     "const vfloat way = rt_vfloat(0.0f);", "PathTruth.IsMet/glass"},
};

TEST(PathTruthTexts, HaveTheirTexts) {
    expect_plantable(kTruthFaults);
}

TEST(PathTruthFaults, AreFound) {
    expect_found(kTruthFaults);
}
