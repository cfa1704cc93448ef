// path_truth_test.cpp -- the whole program meets the closed forms of light, by every strategy.
#include <gtest/gtest.h>

#include <cmath>

#include "images/path_checks.hpp"
#include "reference/closed_forms.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;
using reference::ClosedForm;

namespace {

struct Mean {
    double value[3] = {}, error[3] = {};
};

// The mean of a picture whose pixels expect the same light, and its standard error by their spread.
Mean mean_of(const ClosedForm& form, unsigned samples, const char* strategy, int seed) {
    const FloatImage image = trace_paths(form.scene, form.view, samples,
                                         {{"depth", std::to_string(form.depth)},
                                          {"size", "32x32"},
                                          {"sampler", "independent"},
                                          {"strategy", strategy},
                                          {"seed", std::to_string(seed)}})
                                 .mean;
    Mean mean;
    const double n = double(image.pixels.size() / 3);
    for (size_t c = 0; c < 3; ++c) {
        double squares = 0;
        for (size_t i = c; i < image.pixels.size(); i += 3) {
            mean.value[c] += double(image.pixels[i]) / n;
            squares += double(image.pixels[i]) * image.pixels[i] / n;
        }
        mean.error[c] = std::sqrt(std::max(0.0, squares - mean.value[c] * mean.value[c]) / (n - 1));
    }
    return mean;
}

// Floats of sums and weights: 1e-5 of the value.
bool meets(const ClosedForm& form, const Mean& mean) {
    for (size_t c = 0; c < 3; ++c)
        if (!(std::fabs(mean.value[c] - form.expected[c]) <= 4 * mean.error[c] + form.rounding + 2e-5 * form.expected[c]))
            return false;
    return true;
}

bool begins(const std::string& text, const char* with) {
    return text.rfind(with, 0) == 0;
}

// Fixed seeds; a failure is repeated with another one. bound: the most that the standard error may be of the value, so that the
// test tells something.
void expect_truth(const ClosedForm& form, unsigned samples, const char* strategy, double bound) {
    Mean mean = mean_of(form, samples, strategy, 1);
    if (!meets(form, mean)) mean = mean_of(form, samples, strategy, 2);
    EXPECT_TRUE(meets(form, mean)) << form.name << " by " << strategy << ": " << mean.value[0] << " " << mean.value[1] << " "
                                   << mean.value[2] << " +- " << mean.error[0] << " instead of " << form.expected[0] << " "
                                   << form.expected[1] << " " << form.expected[2];
    EXPECT_LE(mean.error[0], bound * (form.expected[0] + 0.005))
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

INSTANTIATE_TEST_SUITE_P(, PathTruth, testing::Values("furnaces", "lights", "rooms", "glass"),
                         [](const auto& info) { return std::string(info.param); });

// Faults of surfaces, each planted into the text of a kernel.
TEST(PathTruthFaults, AreFound) {
    const PlantedFault faults[] = {
        {"density off by 2", "shading/bsdf.h", "*pdf = rt_select(above, p.diffuse * cosine, zero);",
         "*pdf = rt_select(above, rt_vfloat(2.0f) * p.diffuse * cosine, zero);", "PathTruth.IsMet/rooms"},
        {"normals of the wrong side", "shading/point.h", "const vfloat side = rt_select(p.leaving, -one, one);",
         "const vfloat side = one;", "PathTruth.IsMet/furnaces"},
        {"eta^2 missing", "shading/bsdf.h", "rt_scale(glass_share / (b->eta * b->eta), b->color)",
         "rt_scale(glass_share, b->color)", "PathTruth.IsMet/glass"},
        {"roughness squared twice", "shading/bsdf_of.h", "alpha = m->roughness * m->roughness;",
         "alpha = m->roughness * m->roughness * m->roughness * m->roughness;", "PathTruth.IsMet/furnaces"},
        {"no Beer-Lambert", "tracers/path/scatter.h", "const vfloat way = -rt_min(distance, rt_vfloat(1e30f));",
         "const vfloat way = rt_vfloat(0.0f);", "PathTruth.IsMet/glass"},
    };
    for (const PlantedFault& fault : faults) EXPECT_EQ(why_not_found(fault), "") << fault.name;
}
