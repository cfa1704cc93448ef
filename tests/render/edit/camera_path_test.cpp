// camera_path_test.cpp -- cameras that move from key to key: as text, and as the text scene that is made of them.
#include "render/view/camera_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "render/edit/edit.hpp"
#include "scene/motion/pose.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

namespace clarity::test {
namespace {

Camera camera(const std::array<float, 3>& eye, const std::array<float, 3>& target, float fov_deg = 45,
              const std::array<float, 3>& up = {0, 1, 0}) {
    Camera camera;
    camera.eye = eye;
    camera.target = target;
    camera.up = up;
    camera.fov_y_rad = fov_deg * 3.14159265f / 180;
    return camera;
}

CameraPath three_keys() {
    CameraPath path;
    path.set(2, camera({4, 1, 0}, {0, 1, 0}, 30));
    path.set(0, camera({0, 1, 4}, {0, 1, 0}));
    path.set(3.5, camera({0, 5, 0.5f}, {0, 0, 0}, 60, {0, 0, -1}));
    return path;
}

std::array<double, 3> forward(const Camera& c) {
    std::array<double, 3> w{};
    double size = 0;
    for (int k = 0; k < 3; ++k) {
        w[k] = double(c.target[k]) - c.eye[k];
        size += w[k] * w[k];
    }
    for (double& x : w) x /= std::sqrt(size);
    return w;
}

TEST(CameraPath, KeysAreKeptByTime) {
    CameraPath path = three_keys();
    ASSERT_EQ(path.keys.size(), 3u);
    EXPECT_EQ(path.keys[1].time_s, 2);
    EXPECT_EQ(path.key_at(3.5), 2);
    EXPECT_EQ(path.key_at(1), -1);
    path.set(2, camera({9, 9, 9}, {0, 0, 0}));
    EXPECT_EQ(path.keys.size(), 3u);
    EXPECT_EQ(path.at(2).eye, (std::array<float, 3>{9, 9, 9}));
}

TEST(CameraPath, GoesEvenlyFromKeyToKeyAndRestsOutside) {
    const CameraPath path = three_keys();
    EXPECT_EQ(path.at(-1).eye, path.keys[0].camera.eye);
    EXPECT_EQ(path.at(9).target, path.keys[2].camera.target);
    const Camera half = path.at(1);
    EXPECT_NEAR(half.eye[0], 2, 1e-5);
    EXPECT_NEAR(half.eye[2], 2, 1e-5);
    EXPECT_NEAR(half.fov_y_rad, 37.5 * 3.14159265 / 180, 1e-5);
    // From looking along -z to looking along -x: half way between them.
    EXPECT_NEAR(forward(half)[0], -std::sqrt(0.5), 1e-5);
    EXPECT_NEAR(forward(half)[2], -std::sqrt(0.5), 1e-5);
}

TEST(CameraPath, IsReadBackFromItsText) {
    const CameraPath path = three_keys();
    EXPECT_TRUE(read_path(path_text(path)) == path) << path_text(path);
    EXPECT_TRUE(read_path("").empty());
    for (const char* wrong :
         {"0", "0:1,2,3", "x:0,0,5,0,0,0,45,0,1,0", "1:0,0,5,0,0,0,45,0,1,0;1:0,0,5,0,0,0,45,0,1,0", "0:0,0,5,0,0,0,200,0,1,0"})
        EXPECT_THROW(read_path(wrong), Error) << wrong;
}

// The text scene's `animate` shows the same camera at all times.
TEST(CameraPath, ATextSceneMovesItsCameraAlike) {
    const Scratch scratch;
    const CameraPath path = three_keys();
    const ScenePtr scene = load_scene(scratch.write("path.scene", animate_lines(path, "flight") + "sphere\n"));
    for (double time = -0.5; time < 4.5; time += 0.125) {
        const Camera ours = path.at(time), theirs = evaluate(*scene, {}, time).cameras.at(0);
        EXPECT_NEAR(ours.fov_y_rad, theirs.fov_y_rad, 1e-5) << time;
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(ours.eye[k], theirs.eye[k], 1e-5) << time;
            EXPECT_NEAR(forward(ours)[k], forward(theirs)[k], 1e-5) << time;
        }
        // The upright axis of the picture.
        Camera a = ours, b = theirs;
        double along = 0, size_a = 0, size_b = 0;
        const auto wa = forward(a), wb = forward(b);
        double da = 0, db = 0;
        for (int k = 0; k < 3; ++k) {
            da += a.up[k] * wa[k];
            db += b.up[k] * wb[k];
        }
        for (int k = 0; k < 3; ++k) {
            const double x = a.up[k] - da * wa[k], y = b.up[k] - db * wb[k];
            along += x * y;
            size_a += x * x;
            size_b += y * y;
        }
        EXPECT_NEAR(along / std::sqrt(size_a * size_b), 1, 1e-5) << time;
    }
    EXPECT_EQ(animate_lines({}, "flight"), "");
}

// Presets and command lines carry it. A camera that is set after the path has left it.
TEST(CameraPath, IsAnEdit) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    EditedView edited;
    edited.view = make_view(*scene, 1);
    const View base = edited.view;
    apply_edit(*scene, edited, "camera_path", path_text(three_keys()));
    EXPECT_TRUE(edited.follows_path);
    EditedView from;
    from.view = base;
    std::vector<Word> words = edits_between(*scene, from, edited);
    ASSERT_EQ(words.size(), 1u);
    EXPECT_EQ(words[0].key, "camera_path");
    apply_edit(*scene, edited, "camera", "0,0,5,0,0,0,45,0,1,0");
    EXPECT_FALSE(edited.follows_path);
    words = edits_between(*scene, from, edited);
    ASSERT_EQ(words.size(), 2u);
    EXPECT_EQ(words[1].key, "camera");
    EXPECT_TRUE(is_edit("camera_path"));
}

}  // namespace
}  // namespace clarity::test
