// accel_choice_test.cpp -- which structure holds a scene if the user names none.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "plugin/parameters.hpp"
#include "support/errors.hpp"
#include "support/generated.hpp"
#include "support/workbench.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity::test {
namespace {

const PluginRegistry& plugins() {
    return Workbench::get().plugins();
}

TEST(AccelChoice, TakesTheBestForTheKindOfDevice) {
    EXPECT_STREQ(best_accel(plugins(), DeviceKind::cpu).id, "bvh8");
    EXPECT_STREQ(best_accel(plugins(), DeviceKind::gpu).id, "bvh4");
    const auto by_merit = accels_by_merit(plugins(), DeviceKind::gpu);
    ASSERT_EQ(by_merit.size(), plugins().accels().size());
    for (size_t i = 1; i < by_merit.size(); ++i) {
        const rt_plugin &better = *by_merit[i - 1], &worse = *by_merit[i];
        EXPECT_GE(better.accel->merit_gpu, worse.accel->merit_gpu) << better.id << ", " << worse.id;
        if (better.accel->merit_gpu == worse.accel->merit_gpu) {
            EXPECT_LT(std::string(better.id), worse.id);
        }
    }
}

TEST(AccelChoice, OneGpuAmongTheDevicesDecides) {
    DeviceInfo cpu, gpu;
    cpu.cpu = true;
    gpu.cpu = false;
    EXPECT_EQ(kind_of({cpu, cpu}), DeviceKind::cpu);
    EXPECT_EQ(kind_of({cpu, gpu}), DeviceKind::gpu);
}

TEST(AccelChoice, ResolvedSettingsNameTheStructureAndItsParameters) {
    Settings settings;
    EXPECT_EQ(settings.accel, "");
    const rt_plugin& best = resolve_accel(plugins(), DeviceKind::cpu, settings);
    EXPECT_EQ(settings.accel, best.id);
    EXPECT_EQ(settings.accel_params, default_parameters(best));
    settings.accel = "spheres";
    EXPECT_STREQ(resolve_accel(plugins(), DeviceKind::gpu, settings).id, "spheres") << "named ones stay";
    settings.accel = "nothing";
    expect_error([&] { resolve_accel(plugins(), DeviceKind::cpu, settings); }, {"bvh2"}, Exit::usage);
}

TEST(AccelChoice, PreparedSettingsNameTheStructure) {
    const auto prepared = Workbench::get().prepare(shared_scene(scene_of(box(1))), make_settings({{"size", "8x8"}}));
    const DeviceKind kind = kind_of({Workbench::get().device().info()});
    EXPECT_EQ(prepared->settings.accel, best_accel(plugins(), kind).id);
    EXPECT_EQ(prepared->accel->plugin->id, prepared->settings.accel);
}

}  // namespace
}  // namespace clarity::test
