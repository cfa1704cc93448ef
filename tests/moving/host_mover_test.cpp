// host_mover_test.cpp -- structures that follow the poses of their scene by refits.
#include "moving/on_host/host_mover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "base/error.hpp"
#include "moving_scenes.hpp"
#include "plugin/capabilities.hpp"
#include "stand/multi_preparer.hpp"
#include "support/workbench.hpp"
#include "tracers/rays/ray_queries.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity::test {
namespace {

std::string bytes_of(const AlignedBytes& bytes) {
    return {static_cast<const char*>(bytes.data()), bytes.bytes()};
}
void expect_same(const AccelData& a, const AccelData& b) {
    for (size_t s = 0; s < a.slots.size(); ++s)
        EXPECT_TRUE(bytes_of(a.slots[s].memory) == bytes_of(b.slots[s].memory)) << "slot " << s;
    EXPECT_TRUE(bytes_of(a.leaves) == bytes_of(b.leaves));
    ASSERT_EQ(a.instances.size(), b.instances.size());
    for (size_t i = 0; i < a.instances.size(); ++i)
        EXPECT_EQ(std::memcmp(&a.instances[i], &b.instances[i], sizeof(rt_instance)), 0) << i;
    EXPECT_EQ(a.scene.bounds.min, b.scene.bounds.min);
    EXPECT_EQ(a.scene.bounds.max, b.scene.bounds.max);
}

std::vector<const rt_plugin*> refitting() {
    std::vector<const rt_plugin*> plugins;
    for (const rt_plugin* plugin : Workbench::get().plugins().accels())
        if (refit_of(*plugin).refit) plugins.push_back(plugin);
    return plugins;
}

TEST(HostMover, OurTreesOfferIt) {
    std::set<std::string> ids;
    for (const rt_plugin* plugin : refitting()) ids.insert(plugin->id);
    for (const char* id : {"bvh2", "bvh4", "bvh8", "cwbvh", "spheres"}) EXPECT_TRUE(ids.count(id)) << id;
}

TEST(HostMover, ThePoseOfTheBuildGivesTheBytesOfTheBuild) {
    Progress progress;
    for (const rt_plugin* plugin : refitting()) {
        SCOPED_TRACE(plugin->id);
        const auto built = build(rings(), *plugin);
        HostMover moving(rings(), built);
        const MovedStructure moved = moving.move(pose_at_rest(*rings()), progress);
        ASSERT_TRUE(moved.accel) << moved.why;
        expect_same(*moved.accel, *built);
        EXPECT_DOUBLE_EQ(moved.worst_cost_ratio, 1);
        // There and back again.
        ASSERT_TRUE(moving.move(waved(*rings(), 1), progress).accel);
        expect_same(*moving.move(pose_at_rest(*rings()), progress).accel, *built);
    }
}

TEST(HostMover, LeavesAndInstancesAreThoseOfAFreshBuild) {
    Progress progress;
    const Scene moved_scene = posed(*rings(), waved(*rings(), 2));
    const BuildScene fresh = make_build_scene(moved_scene, progress);
    for (const rt_plugin* plugin : refitting()) {
        SCOPED_TRACE(plugin->id);
        HostMover moving(rings(), build(rings(), *plugin));
        const MovedStructure moved = moving.move(waved(*rings(), 2), progress);
        ASSERT_TRUE(moved.accel) << moved.why;
        const auto* leaves = static_cast<const rt_packed_prim*>(moved.accel->leaves.data());
        for (uint64_t i = 0; i < moved.accel->leaf_count; ++i) {
            const rt_u32 index = RT_REF_INDEX(leaves[i].ref);
            const rt_packed_prim& expected = RT_REF_KIND(leaves[i].ref) == RT_REF_TRIANGLE ? fresh.triangles[index]
                                             : RT_REF_KIND(leaves[i].ref) == RT_REF_SPHERE ? fresh.spheres[index]
                                                                                           : fresh.instance_leaves[index];
            ASSERT_EQ(std::memcmp(&leaves[i], &expected, sizeof expected), 0) << "leaf " << i;
        }
        for (size_t i = 0; i < fresh.instances.size(); ++i)
            EXPECT_EQ(std::memcmp(moved.accel->instances[i].object_from_world, fresh.instances[i].object_from_world, 48), 0);
        EXPECT_EQ(moved.accel->scene.bounds.min, fresh.bounds.min);
        EXPECT_EQ(moved.accel->scene.bounds.max, fresh.bounds.max);
        EXPECT_EQ(moved.groups.size(), 2u);
        EXPECT_EQ(moved.refitted, moved.accel->leaf_count);
    }
}

std::vector<rt_hit> trace(const ScenePtr& scene, const std::shared_ptr<const AccelData>& accel,
                          const std::vector<rt_ray>& rays) {
    Progress progress;
    Workbench& bench = Workbench::get();
    const auto prepared = prepare_queries(const_cast<Device&>(bench.device()), scene, accel, {}, progress);
    RayQueries queries(bench.shared_device());
    std::vector<rt_hit> hits;
    queries.trace(*prepared, RayBlocks(rays, prepared->layout.lanes), {}, &hits);
    return hits;
}

TEST(HostMover, RaysHitWhatTheyHitInAFreshBuild) {
    Progress progress;
    const auto moved_scene = std::make_shared<const Scene>(posed(*rings(), waved(*rings(), 3)));
    const std::vector<rt_ray> rays = rays_at_rings(4000);
    size_t hit = 0;
    Workbench& bench = Workbench::get();
    const std::vector<std::string> tried = bench.fast_accels();  // a quick test compiles the kernels of one alone
    for (const rt_plugin* plugin : refitting()) {
        if (std::find(tried.begin(), tried.end(), plugin->id) == tried.end()) continue;
        SCOPED_TRACE(plugin->id);
        HostMover moving(rings(), build(rings(), *plugin));
        const auto refitted = trace(moved_scene, moving.move(waved(*rings(), 3), progress).accel, rays);
        const auto fresh = trace(moved_scene, build(moved_scene, *plugin), rays);
        hit = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(refitted[i].t, fresh[i].t) << "ray " << i;
            hit += std::isfinite(fresh[i].t);
        }
    }
    EXPECT_GT(hit, rays.size() / 10);
}

TEST(HostMover, ResultsStayAsTheyAreWhileSomeoneHoldsThem) {
    Progress progress;
    HostMover moving(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    const auto first = moving.move(waved(*rings(), 1), progress).accel;
    const std::string leaves = bytes_of(first->leaves), nodes = bytes_of(first->slots[0].memory);
    for (int i = 2; i < 6; ++i) moving.move(waved(*rings(), float(i)), progress);
    EXPECT_TRUE(bytes_of(first->leaves) == leaves);
    EXPECT_TRUE(bytes_of(first->slots[0].memory) == nodes);
}

TEST(HostMover, MemoryIsUsedAgain) {
    Progress progress;
    HostMover moving(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    std::set<const AccelData*> different;
    std::shared_ptr<const AccelData> shown;
    for (int i = 0; i < 10; ++i) {
        shown = moving.move(waved(*rings(), float(i)), progress).accel;
        different.insert(shown.get());
    }
    EXPECT_LE(different.size(), 2u);
    // Buffers that lag behind by several poses are brought up to date.
    const auto now = moving.move(pose_at_rest(*rings()), progress).accel;
    expect_same(*now, *build(rings(), *Workbench::get().plugins().accel("bvh2")));
}

TEST(HostMover, OnlyWhatMovedIsRefitted) {
    Progress progress;
    HostMover moving(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    moving.move(pose_at_rest(*rings()), progress);
    Pose pose = pose_at_rest(*rings());
    EXPECT_EQ(moving.move(pose, progress).refitted, 0u);
    pose.instances[5].world_from_object = moved_to(0, 6, 0);
    const MovedStructure placed = moving.move(pose, progress);
    ASSERT_EQ(placed.groups.size(), 1u) << "the instanced mesh itself stays";
    EXPECT_EQ(placed.groups[0].group, 0u);
    const auto fresh = std::make_shared<const Scene>(posed(*rings(), pose));
    EXPECT_EQ(placed.accel->scene.bounds.max, build(fresh, *Workbench::get().plugins().accel("bvh2"))->scene.bounds.max);
}

TEST(HostMover, AMeshThatIsKeptApartMovesAlone) {
    Progress progress;
    const rt_plugin& plugin = *Workbench::get().plugins().accel("bvh8");
    auto scene = std::make_shared<Scene>(*rings());
    scene->instances[1].apart = true;
    HostMover moving(scene, build(scene, plugin));
    moving.move(pose_at_rest(*rings()), progress);
    Pose pose = pose_at_rest(*rings());
    pose.meshes.push_back(waved(*rings(), 1).meshes[1]);
    const MovedStructure deformed = moving.move(pose, progress);
    ASSERT_EQ(deformed.groups.size(), 2u) << "its own tree, and the world that holds its instance";
    EXPECT_EQ(deformed.groups[0].primitives, rings()->meshes[1].triangle_count);
}

TEST(HostMover, AnObjectBesideALargeStillMeshMovesAlone) {
    Progress progress;
    const rt_plugin& plugin = *Workbench::get().plugins().accel("bvh8");
    Scene large = scene_of(torus(2, 0.7, 128, 64));
    ASSERT_GE(large.triangle_count(), 1u << 14);
    place(large, add_mesh(large, uv_sphere(1, 24, 16)), moved_to(4, 1, 0));
    EXPECT_TRUE(make_build_scene(large, progress).instances.empty()) << "nothing moves: all is one tree";
    large.instances[1].apart = true;
    const ScenePtr scene = shared_scene(std::move(large));
    HostMover moving(scene, build(scene, plugin));
    Pose pose = pose_at_rest(*scene);
    moving.move(pose, progress);
    pose.instances[1].world_from_object = moved_to(5, 1, 0);
    EXPECT_EQ(moving.move(pose, progress).refitted, 2u) << "the boxes of both";
}

TEST(HostMover, TreesOfAllParametersGiveTheBytesOfTheBuild) {
    Progress progress;
    const PluginRegistry& plugins = Workbench::get().plugins();
    for (const char* choice :
         {"bvh2,max_leaf=1", "bvh2,max_leaf=7,builder=morton", "bvh4,max_leaf=1", "bvh4,builder=morton", "bvh8,max_leaf=1",
          "bvh8,builder=morton", "cwbvh,max_leaf=1", "cwbvh,builder=morton", "bvh2,reinsert=8", "bvh4,reinsert=8",
          "bvh8,reinsert=8", "cwbvh,reinsert=8", "spheres,top_level=true", "spheres,lone_spheres=true", "spheres,max_depth=0",
          "spheres,max_leaf=256", "spheres,max_leaf=1"}) {
        SCOPED_TRACE(choice);
        Settings settings;
        choose_accel(plugins, choice, settings);
        const auto built = std::make_shared<AccelData>(
            build_accel(*rings(), *plugins.accel(settings.accel), settings.accel_params, progress, {}));
        HostMover moving(rings(), built);
        ASSERT_TRUE(moving.move(waved(*rings(), 1), progress).accel);
        expect_same(*moving.move(pose_at_rest(*rings()), progress).accel, *built);
    }
}

TEST(HostMover, CostsTellHowMuchATreeHasSuffered) {
    Progress progress;
    for (const rt_plugin* plugin : refitting()) {
        if (std::string(plugin->id) == "spheres") continue;  // its cost counts the surface of spheres
        SCOPED_TRACE(plugin->id);
        const auto built = build(rings(), *plugin);
        HostMover moving(rings(), built);
        moving.move(pose_at_rest(*rings()), progress);
        Pose pose = pose_at_rest(*rings());
        PosedMesh mesh{0, {}, {}};
        std::mt19937 random(1);
        std::uniform_real_distribution<float> any(-3, 3);
        for (rt_u32 v = 0; v < 3 * rings()->meshes[0].vertex_count; ++v) mesh.positions.push_back(any(random));
        pose.meshes.push_back(mesh);
        EXPECT_GT(moving.move(pose, progress).worst_cost_ratio, 2);
        const MovedStructure back = moving.move(pose_at_rest(*rings()), progress);
        EXPECT_NEAR(back.worst_cost_ratio, 1, 1e-6);
        EXPECT_NEAR(back.accel->stat("sah_cost"), built->stat("sah_cost"), 1e-6);
    }
}

// Where one scene has trees of its own for what the other one flattens, rays that graze an edge may differ.
void expect_same_hits(const ScenePtr& scene, const std::shared_ptr<const AccelData>& accel, const ScenePtr& fresh,
                      const rt_plugin& plugin) {
    const std::vector<rt_ray> rays = rays_at_rings(4000);
    const auto now = trace(scene, accel, rays), wanted = trace(fresh, build(fresh, plugin), rays);
    size_t differ = 0;
    for (size_t i = 0; i < rays.size(); ++i)
        differ += now[i].prim != wanted[i].prim || (now[i].prim >= 0 && std::abs(now[i].t - wanted[i].t) > 1e-4f * wanted[i].t);
    EXPECT_LE(differ, 2u);
}

// An instance that has a tree of its own is hidden and shown without a build, also one that was hidden when it was built.
TEST(HostMover, HiddenInstancesAreNotHit) {
    Progress progress;
    Scene apart = *rings();
    for (Instance& instance : apart.instances) instance.apart = true;
    apart.instances[4].visible = false;
    const auto scene = shared_scene(std::move(apart));
    const std::vector<std::string> tried = Workbench::get().fast_accels();  // a quick test compiles the kernels of one alone
    for (const rt_plugin* plugin : refitting()) {
        if (std::find(tried.begin(), tried.end(), plugin->id) == tried.end()) continue;
        SCOPED_TRACE(plugin->id);
        HostMover moving(scene, build(scene, *plugin));
        Pose pose = pose_at_rest(*scene);
        pose.instances[4].visible = true;
        pose.instances[1].visible = pose.instances[6].visible = false;
        pose.instances[6].world_from_object = {};  // wherever it is
        const MovedStructure moved = moving.move(pose, progress);
        ASSERT_TRUE(moved.accel) << moved.why;
        Scene fresh = *scene;
        for (size_t i = 0; i < fresh.instances.size(); ++i) {
            fresh.instances[i].visible = pose.instances[i].visible;
            fresh.instances[i].apart = false;
        }
        expect_same_hits(scene, moved.accel, shared_scene(std::move(fresh)), *plugin);
        pose.instances[6] = pose_at_rest(*scene).instances[6];
        pose.instances[1].visible = true;
        const MovedStructure back = moving.move(pose, progress);
        ASSERT_TRUE(back.accel) << back.why;
        expect_same_hits(scene, back.accel, rings(), *plugin);
    }
}

TEST(HostMover, SaysWhenABuildIsNeeded) {
    Progress progress;
    HostMover moving(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    const auto refused = [&](auto&& change, const char* why) {
        Pose pose = pose_at_rest(*rings());
        change(pose);
        const MovedStructure moved = moving.move(pose, progress);
        EXPECT_FALSE(moved.accel) << why;
        EXPECT_NE(moved.why.find(why), std::string::npos) << moved.why;
    };
    refused([](Pose& pose) { pose.instances[1].visible = false; }, "`placed 1` is hidden");
    refused([](Pose& pose) { pose.instances[1].world_from_object[0] = -1; }, "`placed 1` is mirrored");
    refused([](Pose& pose) { pose.instances[3].world_from_object[0] = 0; }, "`placed 3` is scaled to nothing");
    refused([](Pose& pose) { pose.instances.pop_back(); }, "instances");
    refused([](Pose& pose) { pose.meshes.push_back({0, {0, 0, 0}, {}}); }, "another number of vertices");
    HostMover linear(rings(), build(rings(), *Workbench::get().plugins().accel("linear")));
    EXPECT_NE(linear.move(pose_at_rest(*rings()), progress).why.find("does not offer `refit`"), std::string::npos);
}

// An instance without depth is moved into the world's tree, while its mesh has a tree of its own for the others. Their vertices
// are in two spaces, so poses need builds.
TEST(HostMover, RefusesAMeshThatIsPlacedFlatAndRound) {
    Progress progress;
    Scene pressed = *rings();
    for (int row = 0; row < 3; ++row) pressed.instances[3].world_from_object[4 * row + 2] = 0;
    const ScenePtr scene = shared_scene(std::move(pressed));
    const rt_plugin& plugin = *Workbench::get().plugins().accel("bvh2");
    HostMover moving(scene, build(scene, plugin));
    EXPECT_NE(moving.cannot().text().find("`placed 3` has no volume"), std::string::npos) << moving.cannot();
    EXPECT_FALSE(moving.move(pose_at_rest(*scene), progress).accel);

    Scene once = *rings();  // a mesh that is placed once may be pressed flat
    for (int row = 0; row < 3; ++row) once.instances[1].world_from_object[4 * row + 2] = 0;
    const ScenePtr flat = shared_scene(std::move(once));
    EXPECT_EQ(HostMover(flat, build(flat, plugin)).cannot(), "");
}

TEST(HostMover, VerticesMayBeWrittenInPlace) {
    Progress progress;
    HostMover moving(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    EXPECT_EQ(moving.vertices(0), nullptr) << "before the first move";
    moving.move(pose_at_rest(*rings()), progress);
    EXPECT_EQ(moving.vertices(1), nullptr) << "it is transformed";
    float* const vertices = moving.vertices(0);
    ASSERT_NE(vertices, nullptr);
    const Pose pose = waved(*rings(), 4);
    std::copy(pose.meshes[0].positions.begin(), pose.meshes[0].positions.end(), vertices);
    moving.touch(0);
    const auto in_place = moving.refit(progress).accel;
    Pose same = pose_at_rest(*rings());
    same.meshes.push_back(pose.meshes[0]);
    HostMover other(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    expect_same(*in_place, *other.move(same, progress).accel);
}

TEST(HostMover, GoesOnAfterACancelledMove) {
    class Cancelling : public Progress {
        bool report(float) override { return cancel(), false; }
    };
    Progress progress;
    Cancelling cancelling;
    HostMover moving(rings(), build(rings(), *Workbench::get().plugins().accel("bvh2")));
    moving.move(pose_at_rest(*rings()), progress);
    EXPECT_THROW(moving.move(waved(*rings(), 1), cancelling), Cancelled);
    expect_same(*moving.move(pose_at_rest(*rings()), progress).accel,
                *build(rings(), *Workbench::get().plugins().accel("bvh2")));
}

}  // namespace
}  // namespace clarity::test
