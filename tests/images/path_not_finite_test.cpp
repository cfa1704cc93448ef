// path_not_finite_test.cpp -- samples of `path` that are not finite are counted, and their pixels show it.
#include <gtest/gtest.h>

#include <cmath>

#include "images/path_checks.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Traced {
    uint64_t counted = 0;
    size_t broken_pixels = 0;
};

Traced trace(int lanes) {
    const Settings settings = make_settings(
        {{"tracer", "path"}, {"lanes", std::to_string(lanes)}, {"packet", "8x8"}, {"size", "32x24"}, {"depth", "2"}});
    const ScenePtr scene = shared_scene(sphere_over_floor());
    Workbench& bench = Workbench::get();
    Progress progress;
    Traced traced;
    traced.counted =
        bench.frames()
            .trace(*bench.prepare(scene, settings, floor_view()), settings, floor_view(), Samples(0, 8), true, progress)
            .not_finite;
    const FloatImage image = bench.frames().read_values();
    for (size_t i = 0; i < image.pixels.size(); i += 3) traced.broken_pixels += !std::isfinite(image.pixels[i + 1]);
    return traced;
}

TEST(PathNotFinite, SamplesAreCountedAndNotHidden) {
    for (const int lanes : {1, 4, 8}) {
        EXPECT_EQ(trace(lanes).counted, 0u) << lanes << " lanes";
        // Two samples of each of three pixels are no number.
        const FaultyKernel planted(
            "tracers/path/state.h", "rt_store_lanes(p->light, 1.0f, light);",
            "rt_store_lanes(p->light, 1.0f, light); { int at[RT_LANES], of[RT_LANES]; rt_store(p->pixel, at); "
            "rt_store(p->sample, of); for (uint l = 0; l < RT_LANES; ++l) if ((at[l] == 5 || at[l] == 300 || "
            "at[l] == 767) && (of[l] == 2 || of[l] == 7)) light[l].y = as_float(0x7fc00000); }");
        const Traced broken = trace(lanes);
        EXPECT_EQ(broken.counted, 6u) << lanes << " lanes";
        EXPECT_EQ(broken.broken_pixels, 3u) << lanes << " lanes";
    }
}

}  // namespace
