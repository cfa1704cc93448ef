// memory_plan_test.cpp -- a scene that does not fit is refused before anything is built, with the sizes. Sums have 64 bits.
#include "structures/memory_plan.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "device/device.hpp"
#include "frames/preparer.hpp"
#include "scene/scene.hpp"
#include "structures/build_scene.hpp"
#include "support/generated.hpp"
#include "support/workbench.hpp"
#include "view/settings/settings.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr uint64_t kGibibyte = uint64_t(1) << 30;

const rt_accel& bvh4() {
    return *Workbench::get().plugins().accel("bvh4")->accel;
}

uint64_t total(const std::vector<MemoryPiece>& pieces) {
    uint64_t sum = 0;
    for (const MemoryPiece& piece : pieces) sum += piece.bytes;
    return sum;
}

// A scene with meshes of so many triangles each, placed that often. It has no triangles: only the counts are used.
Scene counted(const std::vector<std::pair<rt_u32, int>>& meshes) {
    Scene scene;
    for (const auto& [triangles, places] : meshes) {
        Mesh mesh;
        mesh.triangle_count = triangles;
        for (int i = 0; i < places; ++i) {
            Instance instance;
            instance.mesh = static_cast<rt_u32>(scene.meshes.size());
            scene.instances.push_back(instance);
        }
        scene.meshes.push_back(mesh);
    }
    return scene;
}

DeviceInfo device_of(uint64_t global_bytes, uint64_t max_allocation_bytes) {
    DeviceInfo info;
    info.name = "Card";
    info.global_bytes = global_bytes;
    info.max_allocation_bytes = max_allocation_bytes;
    return info;
}

std::string refusal(const std::vector<MemoryPiece>& pieces, const DeviceInfo& device) {
    try {
        check_fits(pieces, device, "100000000 primitives in bvh4");
        return {};
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Exit::failed);
        return error.what();
    }
}

std::string error_of(const Scene& scene) {
    Progress progress;
    try {
        make_build_scene(scene, progress);
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

// Records the stages that begin.
struct Stages : Progress {
    std::vector<std::string> seen;
    void stage(const std::string& name) override { seen.push_back(name); }
};

// Prepares a scene on a device that claims to have this memory. Returns the error's message; empty: none.
std::string prepared_on(uint64_t global_bytes, uint64_t max_allocation_bytes, std::vector<std::string>& stages) {
    DeviceInfo info = choose_device("");
    info.global_bytes = global_bytes;
    info.max_allocation_bytes = max_allocation_bytes;
    Preparer preparer(Workbench::get().plugins(), std::make_shared<Device>(info));
    Settings settings;
    settings.accel = "bvh4";
    Stages progress;
    std::string why;
    try {
        preparer.prepare(shared_scene(scene_of(uv_sphere(1, 200, 100))), settings, progress);
    } catch (const Error& error) {
        why = error.what();
    }
    stages = progress.seen;
    return why;
}

TEST(MemoryPlan, CountsInstancedTrianglesOnce) {
    const SceneCounts once = count_scene(counted({{100'000'000, 1}}));
    EXPECT_EQ(once.triangles, 100'000'000u);
    EXPECT_EQ(once.references, 100'000'000u);
    // One mesh, placed several times: its triangles count once, and each place has a box.
    const SceneCounts often = count_scene(counted({{100'000'000, 20}, {12, 1}}));
    EXPECT_EQ(often.triangles, 100'000'012u);
    EXPECT_EQ(often.references, 100'000'032u);
}

TEST(MemoryPlan, SumsAreOf64Bits) {
    const Scene scene;
    const std::vector<MemoryPiece> pieces = plan_memory({260'000'000, 260'000'000}, scene, bvh4());
    EXPECT_EQ(pieces[0].what, "leaves");
    EXPECT_EQ(pieces[0].bytes, 260'000'003u * uint64_t(48));
    EXPECT_GT(total(pieces), 14 * kGibibyte);
    EXPECT_LT(total(pieces), 16 * kGibibyte);
}

TEST(MemoryPlan, RefusalNamesTheSizes) {
    const std::vector<MemoryPiece> pieces = plan_memory({100'000'000, 100'000'000}, Scene(), bvh4());
    EXPECT_EQ(refusal(pieces, device_of(8 * kGibibyte, 8 * kGibibyte)), "");
    EXPECT_EQ(refusal(pieces, device_of(0, 0)), "");  // the driver does not know its memory
    const std::string piece = refusal(pieces, device_of(8 * kGibibyte, 2 * kGibibyte));
    for (const char* part :
         {"leaves", "100000000 primitives in bvh4", "4.5 GiB", "2.0 GiB", "Card", "one piece", "fewer triangles"})
        EXPECT_NE(piece.find(part), std::string::npos) << part << " is not in: " << piece;
    const std::string all = refusal(pieces, device_of(5 * kGibibyte, 5 * kGibibyte));
    for (const char* part :
         {"5.5 GiB", "leaves 4.5 GiB", "bvh4_nodes", "Card has 5.0 GiB", "fewer triangles", "clarity bench accel"})
        EXPECT_NE(all.find(part), std::string::npos) << part << " is not in: " << all;
}

TEST(MemoryPlan, RefusesBeforeBuildingIfASceneDoesNotFit) {
    std::vector<std::string> stages;
    EXPECT_EQ(prepared_on(kGibibyte, kGibibyte, stages), "");
    EXPECT_FALSE(stages.empty());
    // 40 000 triangles: 1.8 MiB of leaves.
    EXPECT_NE(prepared_on(kGibibyte, 1 << 20, stages).find("in one piece"), std::string::npos);
    EXPECT_TRUE(stages.empty()) << stages.front();
    EXPECT_NE(prepared_on(1 << 20, kGibibyte, stages).find("has 1.0 MiB"), std::string::npos);
    EXPECT_TRUE(stages.empty()) << stages.front();
    // The plan underestimates nodes. The error comes after the build, but before the upload.
    const std::string why = prepared_on(2'450'000, kGibibyte, stages);
    EXPECT_NE(why.find("does not fit"), std::string::npos) << why;
    EXPECT_FALSE(stages.empty());
}

TEST(MemoryPlan, TooManyPrimitivesForTheirIndicesIsAnError) {
    const std::string refs = error_of(counted({{200'000'000, 1}, {200'000'000, 1}}));
    EXPECT_NE(refs.find("400000000 triangles"), std::string::npos) << refs;
    const std::string numbers = error_of(counted({{100'000'000, 30}}));
    EXPECT_NE(numbers.find("3000000000 triangles"), std::string::npos) << numbers;
}

TEST(MemoryPlan, TextsOfSizes) {
    EXPECT_EQ(memory_text(0), "0.0 MiB");
    EXPECT_EQ(memory_text(1 << 20), "1.0 MiB");
    EXPECT_EQ(memory_text(512 << 20), "512 MiB");
    EXPECT_EQ(memory_text(100 * kGibibyte), "100.0 GiB");
}

}  // namespace
