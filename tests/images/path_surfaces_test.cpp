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
        EXPECT_GT(sigmas(inside("oren_nayar", 0)), 10) << fault.to;
    }
}
