// pose_follower_test.cpp -- a structure that follows poses: when it is refitted, when it must be built, and what it says.
#include "moving/follow/pose_follower.hpp"

#include <gtest/gtest.h>

#include <future>
#include <random>
#include <thread>

#include "base/error.hpp"
#include "moving/on_host/host_mover.hpp"
#include "support/generated.hpp"
#include "support/workbench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

using Way = PoseFollower::Way;

class Follower : public ::testing::Test {
 protected:
    Follower() {
        TriangleMesh mesh = uv_sphere(1, 24, 16);
        rest_ = shared_scene(scene_of(mesh));
    }
    // All vertices moved along x, more for higher ones, so that boxes change.
    Pose leaning(float by) const {
        Pose pose;
        for (const Instance& i : rest_->instances) pose.instances.push_back({i.mesh, i.world_from_object, i.visible});
        PosedMesh mesh{0, rest_->positions.copy(), rest_->normals.copy()};
        for (size_t v = 0; v < mesh.positions.size(); v += 3) mesh.positions[v] += by * mesh.positions[v + 1];
        pose.meshes.push_back(mesh);
        return pose;
    }
    // Vertices in another order, so that the tree at rest is of no use; moved along x.
    Pose mixed(float by) const {
        Pose pose = leaning(0);
        std::vector<float>& positions = pose.meshes[0].positions;
        std::mt19937 random(1);
        for (size_t v = positions.size() / 3 - 1; v > 0; --v)
            std::swap_ranges(&positions[3 * v], &positions[3 * v] + 3, &positions[3 * (random() % v)]);
        for (size_t v = 0; v < positions.size(); v += 3) positions[v] += by * positions[v + 1];
        return pose;
    }
    // Shows a pose as the window does. Returns whether it was refitted.
    bool show(const Pose& pose, Way way = Way::automatic, const char* clip = "walk", const char* accel = "bvh2") {
        const auto scene = std::make_shared<const Scene>(posed(*rest_, pose));
        const auto refitted = follower_.refit({rest_, clip}, scene, pose, way, 10, progress_);
        if (refitted.accel) return true;
        const rt_plugin& plugin = *Workbench::get().plugins().accel(accel);
        AccelData data = build_accel(*scene, plugin, default_parameters(plugin), progress_);
        data.build_ms = 10, data.pack_ms = 0;  // the clock's figures are those of a busy machine, too
        const auto built = std::make_shared<const AccelData>(std::move(data));
        follower_.built({rest_, clip}, scene, pose, built, std::make_unique<HostMover>(scene, built));
        return false;
    }
    ScenePtr rest_;
    PoseFollower follower_;
    Progress progress_;
};

TEST_F(Follower, BuildsTheFirstPoseAndRefitsTheNext) {
    EXPECT_FALSE(show(leaning(0)));
    EXPECT_EQ(follower_.update().why, "the first pose");
    EXPECT_TRUE(show(leaning(0.1f)));
    EXPECT_TRUE(follower_.update().refitted);
    EXPECT_EQ(follower_.update().primitives, rest_->triangles.size() / 3);
    EXPECT_EQ(follower_.update().cost_ratios.size(), 2u);
    const Bounds fresh = posed(*rest_, leaning(0.1f)).bounds();
    EXPECT_EQ(follower_.structure()->scene.bounds.max, fresh.max) << "the structure is in the pose";
}

// Two meshes, placed by themselves, of which one deforms.
TEST_F(Follower, SaysWhatWasDoneToEachTree) {
    Scene scene = *rest_;
    scene.meshes[0].name = "body";
    Instance again = scene.instances[0];
    again.world_from_object[3] = 5;
    scene.instances.push_back(again);  // placed twice: a tree of its own
    rest_ = shared_scene(std::move(scene));
    EXPECT_FALSE(show(leaning(0)));
    EXPECT_TRUE(follower_.update().trees.empty());
    EXPECT_TRUE(show(leaning(0.5f)));
    ASSERT_EQ(follower_.update().trees.size(), 2u) << "the mesh, and the instances";
    const auto& trees = follower_.update().trees;
    const auto body = std::find_if(trees.begin(), trees.end(), [](const TreeUpdate& t) { return t.name == "body"; });
    ASSERT_NE(body, trees.end());
    EXPECT_EQ(body->what, "refitted");
    EXPECT_EQ(body->primitives, rest_->triangles.size() / 3);
    EXPECT_GT(body->cost_ratios.back(), 0.5f);
    EXPECT_EQ(body->cost_ratios.back(), follower_.update().cost_ratios.back()) << "the worst of all";
    EXPECT_FALSE(show(leaning(0.6f), Way::build));
    EXPECT_EQ(body->what, "built");
    EXPECT_EQ(body->cost_ratios.back(), 1);
}

TEST_F(Follower, ObeysTheSetting) {
    show(leaning(0));
    EXPECT_FALSE(show(leaning(0.1f), way_of("build")));
    EXPECT_TRUE(show(leaning(0.2f), way_of("refit")));
}

TEST_F(Follower, BuildsForAnotherClipAndForStructuresWithoutRefit) {
    show(leaning(0));
    EXPECT_FALSE(show(leaning(0.1f), Way::automatic, "run"));
    EXPECT_EQ(follower_.update().why, "another scene or clip");
    follower_.reset();
    show(leaning(0), Way::automatic, "walk", "linear");
    EXPECT_FALSE(show(leaning(0.1f), Way::automatic, "walk", "linear"));
    EXPECT_NE(follower_.update().why.find("linear"), std::string::npos) << follower_.update().why;
}

TEST_F(Follower, BuildsForAHiddenInstanceAndForOtherMeshes) {
    show(leaning(0));
    Pose hidden = leaning(0.1f);
    hidden.instances[0].visible = false;
    EXPECT_FALSE(show(hidden));
    EXPECT_NE(follower_.update().why.find("hidden"), std::string::npos) << follower_.update().why;
    show(leaning(0));
    Pose still = leaning(0);
    still.meshes.clear();
    EXPECT_FALSE(show(still)) << "the structure was built for deformed vertices";
}

TEST_F(Follower, BuildsWhenSlowRaysHaveCostAsMuchAsABuild) {
    show(leaning(0));
    int poses = 0;
    while (poses < 10000 && show(mixed(0.001f * static_cast<float>(poses)))) ++poses;
    EXPECT_GT(poses, 0);
    EXPECT_LT(poses, 10000) << "cost ratio " << follower_.update().cost_ratios.back();
    EXPECT_NE(follower_.update().why.find("slow rays"), std::string::npos) << follower_.update().why;
}

TEST_F(Follower, BuildsBesideRefits) {
    const PosedFrom from{rest_, "walk"};
    const Pose last = mixed(0);
    show(leaning(0));
    int poses = 0;
    while (poses < 10000 && !follower_.wants_build_beside(from, last, Way::automatic) && show(mixed(0.001f * float(poses + 1))))
        ++poses;
    ASSERT_TRUE(follower_.wants_build_beside(from, last, Way::automatic));
    EXPECT_FALSE(follower_.wants_build_beside({rest_, "run"}, last, Way::automatic));
    EXPECT_FALSE(follower_.wants_build_beside(from, last, Way::refit));
    const auto scene = std::make_shared<const Scene>(posed(*rest_, last));
    std::promise<void> may_end;
    const rt_plugin& plugin = *Workbench::get().plugins().accel("bvh2");
    follower_.build_beside(from, scene, last, [&](const Scene& of, Progress& progress) {
        may_end.get_future().wait();
        return std::make_shared<const AccelData>(build_accel(of, plugin, default_parameters(plugin), progress));
    });
    EXPECT_FALSE(follower_.wants_build_beside(from, last, Way::automatic)) << "one at a time";
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(show(mixed(0.1f * float(i + 1)))) << follower_.update().why;
        EXPECT_TRUE(follower_.update().building);
        EXPECT_EQ(follower_.take_build(from).accel, nullptr);
    }
    const float before = follower_.update().cost_ratios.back();
    EXPECT_GT(before, 2);
    may_end.set_value();
    BuiltPose built;
    while (!built.accel) built = follower_.take_build(from);
    EXPECT_EQ(built.scene, scene);
    follower_.built(from, built.scene, built.pose, built.accel, std::make_unique<HostMover>(built.scene, built.accel));
    EXPECT_TRUE(show(mixed(0.4f)));
    EXPECT_FALSE(follower_.update().building);
    EXPECT_LT(follower_.update().cost_ratios.back(), 1.5f) << "the tree is of about this pose";
    EXPECT_EQ(follower_.structure()->scene.bounds.max, posed(*rest_, mixed(0.4f)).bounds().max);
}

// A clip of vertex frames: its mesh is mixed up at first, and in order from a tenth of the clip on. The first tree suits the
// first pose only.
TEST_F(Follower, ChoosesTheTreeOfAClipAmongSeveralPoses) {
    Scene scene = *rest_;
    Motion& motion = scene.motion;
    motion.frames = {{0, 0, 0, 3, 0}};
    for (const double time_s : {0.0, 0.1, 1.0}) motion.frame_times.push_back(time_s);
    for (const Pose& pose : {mixed(0), leaning(0), leaning(1)})
        for (const float value : pose.meshes[0].positions) motion.frame_positions.push_back(value);
    motion.clips.push_back({"walk", 0, 0, 1, 0, 1, 24});
    motion.layers.push_back({RT_LAYER_REPLACES, 0, 1});
    rest_ = shared_scene(std::move(scene));
    const PosedFrom from{rest_, "walk"};
    EXPECT_FALSE(show(evaluate(*rest_, "walk", 0)));
    EXPECT_TRUE(show(evaluate(*rest_, "walk", 0.8)));
    ASSERT_TRUE(follower_.wants_choice(from));
    EXPECT_FALSE(follower_.wants_choice({rest_, "run"})) << "nothing is shown of it";
    const double first = follower_.structure()->stat("sah_cost");
    const rt_plugin& plugin = *Workbench::get().plugins().accel("bvh2");
    int builds = 0;
    follower_.choose_beside(from, rest_, [&](const Scene& of, Progress& progress) {
        ++builds;
        return std::make_shared<const AccelData>(build_accel(of, plugin, default_parameters(plugin), progress));
    });
    EXPECT_FALSE(follower_.wants_choice(from)) << "once";
    BuiltPose built;
    while (!built.accel) built = follower_.take_build(from);
    EXPECT_EQ(builds, 5);
    follower_.built(from, built.scene, built.pose, built.accel, std::make_unique<HostMover>(built.scene, built.accel));
    EXPECT_TRUE(show(evaluate(*rest_, "walk", 0.8)));
    EXPECT_LT(follower_.structure()->stat("sah_cost"), 0.5 * first);
    EXPECT_FALSE(follower_.wants_choice(from));
    // It is the best of the five.
    const auto cost_of = [&](double time_s) {
        const Pose at = evaluate(*rest_, "walk", time_s);
        const auto there = std::make_shared<const Scene>(posed(*rest_, at));
        HostMover moving(there,
                         std::make_shared<const AccelData>(build_accel(*there, plugin, default_parameters(plugin), progress_)));
        double sum = 0;
        for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9})
            sum += moving.move(evaluate(*rest_, "walk", t), progress_).accel->stat("sah_cost");
        return sum;
    };
    HostMover chosen(built.scene, built.accel);
    double sum = 0;
    for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9})
        sum += chosen.move(evaluate(*rest_, "walk", t), progress_).accel->stat("sah_cost");
    for (const double t : {0.1, 0.5, 0.9}) EXPECT_LE(sum, cost_of(t) * (1 + 1e-6)) << t;
}

TEST_F(Follower, ABuildBesideEndsWithTheFollower) {
    const PosedFrom from{rest_, "walk"};
    const auto until_cancelled = [](const Scene&, Progress& progress) -> std::shared_ptr<const AccelData> {
        while (!progress.cancelled()) std::this_thread::yield();
        throw Cancelled();
    };
    show(leaning(0));
    follower_.build_beside(from, rest_, leaning(0), until_cancelled);
    follower_.reset();
    follower_.build_beside(from, rest_, leaning(0), until_cancelled);
    EXPECT_EQ(follower_.take_build({rest_, "run"}).accel, nullptr) << "another clip plays";
    follower_.build_beside(from, rest_, leaning(0), [](const Scene&, Progress&) -> std::shared_ptr<const AccelData> {
        throw Error(Exit::failed, "no memory");
    });
    const auto throws = [&] {
        while (!follower_.take_build(from).accel) std::this_thread::yield();
    };
    EXPECT_THROW(throws(), Error);
}

TEST_F(Follower, TheSamePoseIsNotDoneTwice) {
    show(leaning(0));
    const auto scene = std::make_shared<const Scene>(posed(*rest_, leaning(1)));
    const auto first = follower_.refit({rest_, "walk"}, scene, leaning(1), Way::automatic, 10, progress_).accel;
    EXPECT_EQ(first, follower_.refit({rest_, "walk"}, scene, leaning(1), Way::automatic, 10, progress_).accel);
    EXPECT_EQ(follower_.update().cost_ratios.size(), 2u);
}

}  // namespace
