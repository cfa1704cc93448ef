// device_mover_test.cpp -- structures that follow poses on a device, against those that follow them on the host.
#include "moving/on_device/device_mover.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>

#include "moving/on_host/host_mover.hpp"
#include "moving_scenes.hpp"
#include "plugin/capabilities.hpp"
#include "stand/multi_preparer.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::test {
namespace {

// rings(), whose ring and ball are kept apart from the world: on the device nothing of the world's own triangles moves.
ScenePtr rings_apart() {
    static const ScenePtr scene = [] {
        Scene s = *rings();
        s.instances[0].apart = s.instances[1].apart = true;
        return std::make_shared<const Scene>(std::move(s));
    }();
    return scene;
}

class DeviceMoverTest : public ::testing::TestWithParam<BuildForm> {
 protected:
    void SetUp() override {
        Progress progress;
        plugin_ = Workbench::get().plugins().accel("bvh4");
        ASSERT_TRUE(plugin_ && device_build_of(*plugin_).refit);
        built_ = build(rings_apart(), *plugin_);
        Settings settings;
        settings.lanes = 1;
        prepared_ = prepare_queries(device(), rings_apart(), built_, settings, progress);
    }
    static Device& device() { return const_cast<Device&>(Workbench::get().device()); }
    std::unique_ptr<DeviceMover> motion() const {
        return std::make_unique<DeviceMover>(Workbench::get().shared_device(), rings_apart(), built_, prepared_->on_device,
                                             nullptr, GetParam());
    }
    static std::string download(const cl::Buffer& buffer, size_t bytes) {
        std::string text(bytes, 0);
        device().queue().enqueueReadBuffer(buffer, CL_TRUE, 0, bytes, &text[0]);
        return text;
    }
    // The buffers of a structure on the device hold what the host has.
    static void expect_same(const DeviceScene& scene, const AccelData& expected) {
        const DeviceScene::Moving moving = scene.moving();
        const auto same = [](const std::string& bytes, const void* data) {
            return std::memcmp(bytes.data(), data, bytes.size()) == 0;
        };
        const std::string leaves = download(moving.leaves, expected.leaves.bytes());
        for (size_t i = 0; i < expected.leaf_count; ++i)
            ASSERT_EQ(std::memcmp(&leaves[48 * i], static_cast<const char*>(expected.leaves.data()) + 48 * i, 48), 0) << i;
        const std::string nodes = download(moving.slots[0], 128 * expected.slots[0].count);
        const auto* const words = static_cast<const float*>(expected.slots[0].memory.data());
        for (size_t i = 0; i < nodes.size() / 4; ++i) {
            float word;
            std::memcpy(&word, &nodes[4 * i], 4);
            ASSERT_TRUE(word == words[i] || std::memcmp(&word, &words[i], 4) == 0)
                << "word " << i % 32 << " of node " << i / 32 << ": " << word << " instead of " << words[i];
        }
        EXPECT_TRUE(same(download(moving.instances, 64 * expected.instances.size()), expected.instances.data()));
        const std::string bounds = download(moving.bounds, 24);
        EXPECT_TRUE(same(bounds.substr(0, 12), expected.scene.bounds.min.data()));
        EXPECT_TRUE(same(bounds.substr(12), expected.scene.bounds.max.data()));
    }

    const rt_plugin* plugin_ = nullptr;
    std::shared_ptr<const AccelData> built_;
    std::shared_ptr<const Prepared> prepared_;
};

TEST_P(DeviceMoverTest, GivesTheBytesOfTheHost) {
    Progress progress;
    const auto motion = this->motion();
    ASSERT_EQ(motion->cannot(), "");
    HostMover host(rings_apart(), built_);
    for (const float phase : {0.0f, 1.0f, 2.0f, 5.0f}) {
        SCOPED_TRACE(phase);
        const Pose pose = phase > 0 ? waved(*rings_apart(), phase) : pose_at_rest(*rings_apart());
        const MovedOnDevice moved = motion->move(pose);
        ASSERT_TRUE(moved.on_device) << moved.why;
        expect_same(*moved.on_device, *host.move(pose, progress).accel);
    }
    // Copies that lag behind by several poses are brought up to date.
    for (int i = 0; i < 3; ++i) expect_same(*motion->move(pose_at_rest(*rings_apart())).on_device, *built_);
}

TEST_P(DeviceMoverTest, OnlyWhatMovedIsRefitted) {
    const auto motion = this->motion();
    Pose pose = pose_at_rest(*rings_apart());
    motion->move(pose);
    uint64_t refitted = 0;
    for (int i = 0; i < 3; ++i) {
        pose.instances[5].world_from_object = moved_to(0, 6 + float(i), 0);
        refitted = motion->move(pose).refitted;
    }
    EXPECT_EQ(refitted, rings_apart()->instances.size() + 1) << "the instances, and a sphere; the meshes stay";
}

TEST_P(DeviceMoverTest, ResultsStayAsTheyAreWhileSomeoneHoldsThem) {
    const auto motion = this->motion();
    const auto first = motion->move(waved(*rings_apart(), 1)).on_device;
    const std::string nodes = download(first->moving().slots[0], 128 * built_->slots[0].count);
    std::set<const DeviceScene*> others;
    for (int i = 2; i < 9; ++i) others.insert(motion->move(waved(*rings_apart(), float(i))).on_device.get());
    EXPECT_TRUE(nodes == download(first->moving().slots[0], 128 * built_->slots[0].count));
    EXPECT_EQ(others.count(first.get()), 0u);
    EXPECT_LE(others.size(), 2u) << "memory is used again";
}

TEST_P(DeviceMoverTest, CostsTellHowMuchATreeHasSuffered) {
    const auto motion = this->motion();
    Pose pose = pose_at_rest(*rings_apart());
    EXPECT_EQ(motion->move(pose).worst_cost_ratio, 1);
    PosedMesh mesh{0, {}, {}};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> any(-3, 3);
    for (rt_u32 v = 0; v < 3 * rings()->meshes[0].vertex_count; ++v) mesh.positions.push_back(any(random));
    pose.meshes.push_back(mesh);
    Progress progress;
    HostMover host(rings_apart(), built_);
    const double expected = host.move(pose, progress).worst_cost_ratio;
    Pose other = pose;
    other.meshes[0].positions[0] += 1e-4f;
    double ratio = 0;
    for (int i = 0; i < 10; ++i) {
        ratio = motion->move(i % 2 ? pose : other).worst_cost_ratio;
        device().queue().finish();
    }
    EXPECT_NEAR(ratio, expected, 1e-3 * expected) << "some moves later";
}

TEST_P(DeviceMoverTest, SaysWhenABuildIsNeeded) {
    Progress progress;
    Pose pose = pose_at_rest(*rings_apart());
    pose.instances[3].world_from_object[0] = 0;
    EXPECT_NE(motion()->move(pose).why.find("`placed 3` is scaled to nothing"), std::string::npos);
    const auto flat = build(rings(), *plugin_);
    const auto prepared = prepare_queries(device(), rings(), flat, {}, progress);
    DeviceMover world(Workbench::get().shared_device(), rings(), flat, prepared->on_device, nullptr, GetParam());
    EXPECT_NE(world.move(waved(*rings(), 1)).why.find("part of the world"), std::string::npos);
    const auto linear = build(rings(), *Workbench::get().plugins().accel("linear"));
    const auto other = prepare_queries(device(), rings(), linear, {}, progress);
    EXPECT_NE(DeviceMover(Workbench::get().shared_device(), rings(), linear, other->on_device, nullptr, GetParam())
                  .cannot()
                  .text()
                  .find("linear"),
              std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(, DeviceMoverTest, ::testing::Values(BuildForm::groups, BuildForm::serial),
                         [](const auto& info) { return info.param == BuildForm::groups ? "groups" : "serial"; });

// A structure that moves on the device, whose rays are compared with those of a scene that the host has built for the pose.
class DeviceRays : public ::testing::Test {
 protected:
    void start(const char* accel) {
        Progress progress;
        plugin_ = Workbench::get().plugins().accel(accel);
        ASSERT_TRUE(plugin_);
        settings_.lanes = 1;
        const auto built = build(rings_apart(), *plugin_);
        prepared_ = prepare_queries(device(), rings_apart(), built, settings_, progress);
        motion_ = std::make_unique<DeviceMover>(Workbench::get().shared_device(), rings_apart(), built, prepared_->on_device);
        ASSERT_EQ(motion_->cannot(), "");
    }
    static Device& device() { return const_cast<Device&>(Workbench::get().device()); }
    // Moves, and returns the rays' hits.
    std::vector<rt_hit> hits_after(const Pose& pose, DeviceMover::Update update) {
        Prepared moved = *prepared_;
        const MovedOnDevice result = motion_->move(pose, update);
        EXPECT_TRUE(result.on_device) << result.why;
        moved.on_device = result.on_device;
        moved.accel = motion_->accel();
        return trace(moved);
    }
    std::vector<rt_hit> fresh_hits(const Pose& pose) {
        Progress progress;
        auto scene = std::make_shared<Scene>(posed(*rings_apart(), pose));
        scene->instances[0].apart = scene->instances[1].apart = true;
        return trace(*prepare_queries(device(), scene, build(scene, *plugin_), settings_, progress));
    }
    std::vector<rt_hit> trace(const Prepared& prepared) {
        std::vector<rt_hit> hits;
        queries_.trace(prepared, RayBlocks(rays_, 1), {}, &hits);
        return hits;
    }
    static void expect_same(const std::vector<rt_hit>& a, const std::vector<rt_hit>& b) {
        size_t hit = 0;
        for (size_t i = 0; i < a.size(); ++i) {
            ASSERT_EQ(a[i].t, b[i].t) << "ray " << i;
            hit += std::isfinite(b[i].t);
        }
        EXPECT_GT(hit, a.size() / 10);
    }

    const rt_plugin* plugin_ = nullptr;
    Settings settings_;
    std::shared_ptr<const Prepared> prepared_;
    std::unique_ptr<DeviceMover> motion_;
    const std::vector<rt_ray> rays_ = rays_at_rings(2000);
    RayQueries queries_{Workbench::get().shared_device()};
};

TEST_F(DeviceRays, HitWhatTheyHitInAFreshBuild) {
    start("bvh4");
    EXPECT_FALSE(motion_->can_build()) << "the host builds by the heuristic";
    const Pose pose = waved(*rings_apart(), 3);
    expect_same(hits_after(pose, DeviceMover::Update::refit), fresh_hits(pose));
}

TEST_F(DeviceRays, HitTheSameInTreesThatTheDeviceBuilds) {
    using Update = DeviceMover::Update;
    start("lbvh");
    ASSERT_TRUE(motion_->can_build());
    const Pose poses[] = {waved(*rings_apart(), 1), waved(*rings_apart(), 3), pose_at_rest(*rings_apart())};
    std::vector<rt_hit> expected[3];
    for (int p = 0; p < 3; ++p) expected[p] = fresh_hits(poses[p]);
    // Trees that were built, refitted, built once more, and refitted in copies that take over the tree of another copy.
    std::vector<std::shared_ptr<const DeviceScene>> held;
    for (const auto& [p, update] : std::vector<std::pair<int, Update>>{{0, Update::build},
                                                                       {1, Update::refit},
                                                                       {2, Update::refit},
                                                                       {1, Update::build},
                                                                       {0, Update::refit},
                                                                       {2, Update::refit},
                                                                       {1, Update::refit}}) {
        SCOPED_TRACE(p);
        expect_same(hits_after(poses[p], update), expected[p]);
    }
    const auto accel = motion_->accel();
    motion_->move(poses[0], Update::build);
    EXPECT_EQ(motion_->accel(), accel) << "kernels are compiled once more at most";
}

TEST_F(DeviceRays, CostsCountFromTheLastBuild) {
    start("lbvh");
    Pose pose = pose_at_rest(*rings_apart());
    PosedMesh mesh{0, {}, {}};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> any(-3, 3);
    for (rt_u32 v = 0; v < 3 * rings()->meshes[0].vertex_count; ++v) mesh.positions.push_back(any(random));
    pose.meshes.push_back(mesh);
    Pose other = pose;
    other.meshes[0].positions[0] += 1e-4f;
    double ratio = 0;
    for (int i = 0; i < 10; ++i) {
        ratio = motion_->move(i % 2 ? pose : other).worst_cost_ratio;
        device().queue().finish();
    }
    EXPECT_GT(ratio, 5) << "a tree of another pose";
    motion_->move(other, DeviceMover::Update::build);
    for (int i = 1; i < 11; ++i) {
        device().queue().finish();
        ratio = motion_->move(i % 2 ? pose : other).worst_cost_ratio;
    }
    EXPECT_LT(ratio, 1.1);
}

}  // namespace
}  // namespace clarity::test
