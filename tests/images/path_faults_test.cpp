// path_faults_test.cpp -- faults that a path tracer may have, each planted into the text of a kernel: the checks find all.
#include <gtest/gtest.h>

#include <algorithm>

#include "device/kernel_files.hpp"
#include "images/path_checks.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Fault {
    const char *name, *file, *sound, *faulty;
    const char* found_as;  // a word of path_problems()
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
};

class PathFaults : public testing::TestWithParam<Fault> {};

TEST_P(PathFaults, IsFound) {
    const Fault& fault = GetParam();
    std::string text = kernel_text(fault.file);
    const size_t at = text.find(fault.sound);
    ASSERT_NE(at, std::string::npos) << fault.file << " has no `" << fault.sound << "`";
    ASSERT_EQ(text.find(fault.sound, at + 1), std::string::npos) << "several places";
    text.replace(at, std::string(fault.sound).size(), fault.faulty);
    Scratch scratch;
    Environment environment;
    scratch.write(std::string("cl/") + fault.file, text);
    environment.set("CLARITY_KERNEL_PATH", scratch.path("cl"));
    const std::vector<std::string> problems = path_problems(1);
    EXPECT_NE(std::find(problems.begin(), problems.end(), fault.found_as), problems.end())
        << "found: " << testing::PrintToString(problems);
}

INSTANTIATE_TEST_SUITE_P(All, PathFaults, testing::ValuesIn(kFaults),
                         [](const testing::TestParamInfo<Fault>& info) { return std::string(info.param.name); });

}  // namespace
