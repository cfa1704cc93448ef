// far_origin_test.cpp -- coordinates far from 0, as surveys in UTM have them: their details stay, and users see the file's
// coordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "support/scenes.hpp"
#include "support/scratch.hpp"
#include "view/edit/edit.hpp"
#include "view/view.hpp"

namespace clarity::test {
namespace {

constexpr double kEast = 499980.37, kNorth = 5462131.91;

// Two steps of 2 cm in a plot of 8 m.
std::string plot(const char* format) {
    std::string text;
    const double z[3] = {102.31, 102.33, 102.35};
    const auto corner = [&](int x, int y) {
        char line[96];
        std::snprintf(line, sizeof line, format, kEast + 4 * x, kNorth + 4 * y + 0.01, z[x]);
        text += line;
    };
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) corner(x, y);
    return text;
}

void expect_kept(const ScenePtr& scene) {
    ASSERT_EQ(scene->triangle_count(), 4u);
    EXPECT_NE(scene->origin[1], 0);
    const Bounds b = scene->bounds();
    EXPECT_NEAR(b.min[0] + scene->origin[0], kEast, 1e-5);
    EXPECT_NEAR(b.max[0] + scene->origin[0], kEast + 8, 1e-5);
    EXPECT_NEAR(b.min[1] + scene->origin[1], kNorth + 0.01, 1e-5);
    EXPECT_NEAR(b.max[1] + scene->origin[1], kNorth + 4.01, 1e-5);
    EXPECT_NEAR(b.max[2] - b.min[2], 0.04, 1e-5);
    EXPECT_NEAR(scene->surface_area(), 2 * 4 * std::hypot(4, 0.02), 1e-4);
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings.front();
}

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";

TEST(FarOrigin, TextKeepsCentimetres) {
    const Scratch scratch;
    expect_kept(load_scene(scratch.write("a.obj", plot("v %.9g %.9g %.9g\n") + "f 1 2 5 4\nf 2 3 6 5\n")));
    expect_kept(load_scene(scratch.write("a.ply", kPly + plot("%.9g %.9g %.9g\n") + "4 0 1 4 3\n4 1 2 5 4\n")));
    expect_kept(load_scene(scratch.write("a.off", "OFF\n6 2 0\n" + plot("%.9g %.9g %.9g\n") + "4 0 1 4 3\n4 1 2 5 4\n")));
}

// A file that a text scene places keeps them, too.
TEST(FarOrigin, LoadedFilesKeepThem) {
    const Scratch scratch;
    scratch.write("a.obj", plot("v %.9g %.9g %.9g\n") + "f 1 2 5 4\nf 2 3 6 5\n");
    expect_kept(load_scene(scratch.write("a.scene", "load \"a.obj\"\n")));
}

TEST(FarOrigin, CamerasAndLightsAreInTheFilesCoordinates) {
    const Scratch scratch;
    const ScenePtr scene = load_scene(scratch.write("a.obj", plot("v %.9g %.9g %.9g\n") + "f 1 2 5 4\nf 2 3 6 5\n"));
    const View view =
        make_view(*scene, 1, "499984.37,5462133.92,112.33,499984.37,5462133.92,102.33,40", "499984.37,5462133.92,120");
    EXPECT_NEAR(view.camera.eye[0] + scene->origin[0], 499984.37, 1e-5);
    EXPECT_NEAR(view.camera.target[1] + scene->origin[1], 5462133.92, 1e-5);
    EXPECT_NEAR(view.lights.at(0).position[1] + scene->origin[1], 5462133.92, 1e-5);
    // As words that are read again.
    EditedView from, edited;
    from.view = edited.view = view;
    EditedView again = from;
    for (const Word& word : edits_between(*scene, from, edited)) apply_edit(*scene, again, word.key, word.value);
    EXPECT_EQ(again.view.camera.eye, view.camera.eye);
    EXPECT_EQ(again.view.camera.target, view.camera.target);
}

// Floats in a file have lost what an origin could keep: a warning says how much.
TEST(FarOrigin, AWarningSaysWhatFloatsHaveLost) {
    const Scratch scratch;
    std::string stl(84, '\0');
    stl[80] = 1;
    const float facet[12] = {0, 0, 1, 499980.37f, 5462131.91f, 102, 499988.37f, 5462131.91f, 102, 499988.37f, 5462139.9f, 102};
    stl.append(reinterpret_cast<const char*>(facet), sizeof facet);
    stl.append(2, '\0');
    const ScenePtr scene = load_scene(scratch.write("a.stl", stl));
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_NE(scene->warnings[0].find("in steps of 0.5"), std::string::npos) << scene->warnings[0];
    EXPECT_NE(scene->origin[1], 0);
}

// Scenes near 0, and large ones, stay as they are.
TEST(FarOrigin, OtherScenesHaveNone) {
    const Scratch scratch;
    const ScenePtr scene = load_scene(scratch.write("a.obj", "v 10.1 0 0\nv 11.3 0 0\nv 10.1 1.7 0\nf 1 2 3\n"));
    EXPECT_EQ(scene->origin, (std::array<double, 3>{}));
    EXPECT_EQ(scene->positions[0], 10.1f);
}

}  // namespace
}  // namespace clarity::test
