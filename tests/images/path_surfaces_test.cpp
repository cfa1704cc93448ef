// path_surfaces_test.cpp -- pictures by `path` of models that plugins bring: oren_nayar without grooves is lambert.
#include <gtest/gtest.h>

#include <cmath>

#include "images/path_checks.hpp"
#include "scene/material_keys.hpp"
#include "scene/surface_models.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// The inside of a sphere that emits light: what is seen has come directly, by next events and by directions of the surface.
PathPicture inside(const char* model, float grooves) {
    Workbench::get();  // knows the models
    Scene scene = hollow_sphere(0.8f, 1);
    MaterialValues& material = scene.materials[scene.spheres.front().material].values;
    std::array<float, 3> number{};
    std::string expected;
    if (!read_value(material_key("model"), model, number, expected)) throw std::logic_error(expected);
    set_material_value(material, material_key("model"), number);
    if (is_surface_model(material.model)) set_value(*find_material_key(material.model, "grooves"), &material, {grooves, 0, 0});
    return trace_paths(scene, inside_view(false), 64, {{"depth", "4"}, {"sampler", "independent"}});
}

// How many standard errors the mean is away from lambert's.
double sigmas(const PathPicture& picture) {
    static const PathPicture lambert = inside("lambert", 0);
    return std::fabs(picture.average() - lambert.average()) / std::hypot(picture.average_error(), lambert.average_error());
}

}  // namespace

TEST(PathSurfaces, WithoutGroovesItIsLambert) {
    const PathPicture smooth = inside("oren_nayar", 0);
    EXPECT_LT(sigmas(smooth), 4);
    EXPECT_NEAR(smooth.average(), hollow_sphere_radiance(0.8, 4), 4 * smooth.average_error() + 2e-5);
    EXPECT_GT(sigmas(inside("oren_nayar", 1)), 10) << "grooves are seen";
}

TEST(PathSurfaces, FaultsOfTheCallsAreFound) {
    const struct {
        const char *from, *to;
    } faults[] = {
        {"value = in.z * rt_surface_eval_by", "value = rt_surface_eval_by"},
        {"density[l] = draw.pdf;", "density[l] = 2.0f * draw.pdf;"},
    };
    for (const auto& fault : faults) {
        const FaultyKernel planted("shading/surface_lanes.h", fault.from, fault.to);
        if (quick()) continue;  // the text is there
        EXPECT_GT(sigmas(inside("oren_nayar", 0)), 10) << fault.to;
    }
}

// Faults that a path tracer may have, each planted into the text of a kernel: the checks find all.
// Those of lights and skies are in tests/launch/emitters/faults_test.cpp.

namespace {

struct SurfaceFault {
    const char *name, *file, *sound, *faulty;
    const char* found_as;  // the word of path_problems() that must find it
};

const SurfaceFault kSurfaceFaults[] = {
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

class PathFaults : public testing::TestWithParam<SurfaceFault> {};

TEST_P(PathFaults, IsFound) {
    const SurfaceFault& fault = GetParam();
    const FaultyKernel planted(fault.file, fault.sound, fault.faulty);
    if (quick()) return;  // the text is there
    EXPECT_EQ(path_problems(1, fault.found_as), std::vector<std::string>{fault.found_as});
}

INSTANTIATE_TEST_SUITE_P(All, PathFaults, testing::ValuesIn(kSurfaceFaults),
                         [](const testing::TestParamInfo<SurfaceFault>& info) { return std::string(info.param.name); });

}  // namespace
