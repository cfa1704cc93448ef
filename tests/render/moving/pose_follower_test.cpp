// pose_follower_test.cpp -- a structure that follows poses: when it is refitted, when it must be built, and what it says.
#include "render/moving/pose_follower.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
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
        PosedMesh mesh{0, rest_->positions, rest_->normals};
        for (size_t v = 0; v < mesh.positions.size(); v += 3) mesh.positions[v] += by * mesh.positions[v + 1];
        pose.meshes.push_back(mesh);
        return pose;
    }
    // Shows a pose as the window does. Returns whether it was refitted.
    bool show(const Pose& pose, Way way = Way::automatic, const char* clip = "walk", const char* accel = "bvh2") {
        const auto scene = std::make_shared<const Scene>(posed(*rest_, pose));
        const auto refitted = follower_.refit({rest_, clip}, scene, pose, way, 10, progress_);
        if (refitted.accel) return true;
        const rt_plugin& plugin = *Workbench::get().plugins().accel(accel);
        const auto built =
            std::make_shared<const AccelData>(build_accel(*scene, plugin, default_parameters(plugin), progress_));
        follower_.built({rest_, clip}, scene, pose, built, make_host_mover(scene, built));
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
    while (poses < 10000 && show(leaning(3 + 0.001f * static_cast<float>(poses)))) ++poses;
    EXPECT_GT(poses, 0);
    EXPECT_LT(poses, 10000) << "cost ratio " << follower_.update().cost_ratios.back();
    EXPECT_NE(follower_.update().why.find("slow rays"), std::string::npos) << follower_.update().why;
}

TEST_F(Follower, TheSamePoseIsNotDoneTwice) {
    show(leaning(0));
    const auto scene = std::make_shared<const Scene>(posed(*rest_, leaning(1)));
    const auto first = follower_.refit({rest_, "walk"}, scene, leaning(1), Way::automatic, 10, progress_).accel;
    EXPECT_EQ(first, follower_.refit({rest_, "walk"}, scene, leaning(1), Way::automatic, 10, progress_).accel);
    EXPECT_EQ(follower_.update().cost_ratios.size(), 2u);
}

}  // namespace
