// path_faults_test.cpp -- faults that a path tracer may have, each planted into the text of a kernel: the checks find all.
// Those of lights and skies are in tests/render/emitters/faults_test.cpp.
#include <gtest/gtest.h>

#include "images/path_checks.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Fault {
    const char *name, *file, *sound, *faulty;
    const char* found_as;  // the word of path_problems() that must find it
};

const Fault kFaults[] = {
    {"NoCosine", "tracers/path/scatter.h", "rt_mul(light, s.radiance_over_pdf)",
     "rt_scale(rt_vfloat(1.0f) / rt_max(wi.z, rt_vfloat(1e-3f)), rt_mul(light, s.radiance_over_pdf))", "cosine"},
    {"RouletteWithoutWeight", "tracers/path/scatter.h", "weight = rt_scale(one / chance, weight);", "", "roulette"},
    {"TwoDimensionsAreTheSame", "tracers/path/scatter.h", "m->wo, n.a, n.b, n.c, lanes", "m->wo, n.a, n.b, n.b, lanes",
     "directions"},
    {"SeedIsNotOfThePixel", "sampling/dimensions.h", "rt_as_vuint(s->pixel)", "rt_vuint(0u)", "noise"},
    {"LastEventWithoutNextEvent", "tracers/path/scatter.h", "rt_next_event(ctx, frame, p, scattered, &m",
     "rt_next_event(ctx, frame, p, scattered & RT_MASK(p->event + rt_vint(1) < rt_vint((int)frame->depth)), &m", "last event"},
    {"WeightsAreSwapped", "tracers/path/scatter.h", "rt_mis_weight(frame, s->pdf, surface_pdf)",
     "rt_mis_weight(frame, surface_pdf, s->pdf)", "directions"},
    {"DensityOffByTwo", "shading/bsdf.h", "*pdf = rt_select(above, p.diffuse * cosine, zero);",
     "*pdf = rt_select(above, rt_vfloat(2.0f) * p.diffuse * cosine, zero);", "depth"},
    {"NormalsOfTheWrongSide", "shading/point.h", "const vfloat side = rt_select(p.leaving, -one, one);",
     "const vfloat side = one;", "depth"},
    {"EtaSquaredIsMissing", "shading/bsdf.h", "bent_share = glass_share / (b->eta * b->eta)", "bent_share = glass_share",
     "glass"},
    {"RoughnessIsSquaredTwice", "shading/bsdf_of.h", "alpha = m->roughness * m->roughness;",
     "alpha = m->roughness * m->roughness * m->roughness * m->roughness;", "facets"},
};

class PathFaults : public testing::TestWithParam<Fault> {};

TEST_P(PathFaults, IsFound) {
    const Fault& fault = GetParam();
    const FaultyKernel planted(fault.file, fault.sound, fault.faulty);
    EXPECT_EQ(path_problems(1, fault.found_as), std::vector<std::string>{fault.found_as});
}

INSTANTIATE_TEST_SUITE_P(All, PathFaults, testing::ValuesIn(kFaults),
                         [](const testing::TestParamInfo<Fault>& info) { return std::string(info.param.name); });

}  // namespace
