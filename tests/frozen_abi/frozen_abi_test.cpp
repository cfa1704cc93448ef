// Plugins that were built with the SDK of a frozen ABI version are listed, trace like `linear`, and import what they did.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "import/import.hpp"
#include "stand/levels.hpp"
#include "stand/ray_sets.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;
namespace fs = std::filesystem;

namespace {

TEST(FrozenAbi, AllPluginsAreListed) {
    size_t found = 0;
    for (const PluginRecord& record : Workbench::get().plugins().records()) {
        if (fs::path(record.path).parent_path() != FROZEN_PLUGINS) continue;
        ++found;
        EXPECT_NE(record.plugin, nullptr) << record.path << ": " << record.why;
        EXPECT_FALSE(record.shadowed);
    }
    EXPECT_EQ(found, 3u);
}

TEST(FrozenAbi, FieldsAreReadFromTheirPlaces) {
    const rt_plugin* grid = Workbench::get().plugins().accel("frozen2_grid");
    ASSERT_NE(grid, nullptr);
    EXPECT_STREQ(grid->params[0].key, "cells");
    EXPECT_EQ(grid->params[0].max, 64);
    EXPECT_EQ(grid->accel->kernel_contract, 1u);
    EXPECT_EQ(grid->accel->slot_count, 4u);
    EXPECT_EQ(grid->accel->slots[3].flags, RT_SLOT_HOST_ONLY);
    EXPECT_STREQ(grid->extensions[0].name, "org.example.nothing");
}

class FrozenAccel : public ::testing::TestWithParam<std::string> {};

TEST_P(FrozenAccel, HitsWhatLinearHits) {
    // Each pair needs kernels of its own, and compiling them takes most of the time.
    const std::pair<ScenePtr, const char*> cases[] = {{load_scene(source_file("scenes/primitives.scene")), "8"},
                                                      {rubble(), "1"}};
    for (const auto& [scene, lanes] : cases)
        for (const bool any_hit : {false, true}) {
            if (few_ways() && any_hit != (lanes == std::string("1"))) continue;
            SCOPED_TRACE(GetParam() + ", " + lanes + " lanes, " + (any_hit ? "any" : "nearest"));
            const std::vector<rt_ray> rays = random_rays(scene->bounds(), 4096, 7);
            const auto expected =
                Workbench::get().rays(scene, make_settings({{"accel", "linear"}, {"lanes", lanes}}), rays, any_hit);
            const auto found =
                Workbench::get().rays(scene, make_settings({{"accel", GetParam()}, {"lanes", lanes}}), rays, any_hit);
            size_t hits = 0, differing = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                hits += std::isfinite(expected[i].t);
                differing += expected[i].t != found[i].t;
            }
            EXPECT_GT(hits, rays.size() / 10);
            EXPECT_EQ(differing, 0u);
        }
}
INSTANTIATE_TEST_SUITE_P(Version2, FrozenAccel, testing::Values("frozen2_grid", "frozen2_median"));

TEST(FrozenAbi, LevelsAreDrawn) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const auto grid = Workbench::get().prepare(scene, make_settings({{"accel", "frozen2_grid"}}));
    EXPECT_GE(accel_volumes(*grid->accel, 0, 1000).boxes.size(), 1u);
    EXPECT_GT(accel_volumes(*grid->accel, RT_LEVEL_BOTTOM, 1000).boxes.size(), 3u);
    // A topology shows the volumes of its layout.
    const auto median = Workbench::get().prepare(scene, make_settings({{"accel", "frozen2_median"}}));
    EXPECT_GE(accel_volumes(*median->accel, 0, 1000).boxes.size(), 1u);
}

class FrozenImporter : public ::testing::TestWithParam<bool> {};

TEST_P(FrozenImporter, ImportsWhatItDid) {
    Scratch scratch;
    const std::string other = scratch.write("other.frozen2", "sphere 9 9 9 0.5\n");
    const std::string path = scratch.write("all.frozen2",
                                           "material 1 0.5 0.25\nsphere 0 0 1 1\nplane 0 0 1 0\n"
                                           "square 2 0 0 3 0 0 3 1 0 2 1 0\npolygon -3 0 1 -2 0 1 -2 1 1\n"
                                           "lamp 0 -3 5\nsun 0 3 -4\ncamera 0 -8 3\nload other.frozen2\nodd\n");
    import::ImportOptions options;
    options.in_process = GetParam();
    options.log_warnings = false;
    Progress progress;
    const Scene scene = import::import_scene(Workbench::get().plugins(), {path}, options, progress);
    ASSERT_EQ(scene.materials.size(), 2u);
    const rt_material& paint = scene.materials[1].values;
    EXPECT_EQ(scene.materials[1].name, "paint");
    EXPECT_EQ(paint.color[1], 0.5f);
    EXPECT_EQ(paint.specular[0], 0.15f);
    EXPECT_EQ(paint.reflect, 0.25f) << "the parameter's default";
    EXPECT_EQ(paint.ior, 1.5f);
    EXPECT_EQ(paint.flags, RT_MATERIAL_CHECKER);
    EXPECT_EQ(paint.texture, 0u);
    EXPECT_EQ(scene.textures.size(), 1u);
    ASSERT_EQ(scene.spheres.size(), 2u);
    EXPECT_EQ(scene.spheres[0].material, 1u);
    EXPECT_EQ(scene.planes.size(), 1u);
    EXPECT_EQ(scene.polygons.size(), 1u);
    EXPECT_EQ(scene.triangle_count(), 2u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[1].world_from_object[11], 3);
    EXPECT_EQ(scene.triangle_materials[0], 1u);
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].name, "lamp");
    EXPECT_EQ(scene.lights[0].values.kind, RT_LIGHT_POINT);
    EXPECT_EQ(scene.lights[0].values.position[2], 5);
    EXPECT_EQ(scene.lights[1].values.kind, RT_LIGHT_DIRECTIONAL);
    EXPECT_FLOAT_EQ(scene.lights[1].values.position[1], -0.6f) << "towards the light";
    EXPECT_FLOAT_EQ(scene.lights[1].values.position[2], 0.8f);
    EXPECT_EQ(scene.lights[1].values.color[0], 1);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].eye[1], -8);
    EXPECT_EQ(scene.up_axis, 2u);
    EXPECT_EQ(scene.unit_scale, 0.01);
    EXPECT_EQ(scene.background[2], 0.75f);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("left out: odd"), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(Places, FrozenImporter, testing::Bool(),
                         [](const auto& info) { return info.param ? "InProcess" : "InWorker"; });

}  // namespace
