// watertight_test.cpp -- no ray leaves a closed mesh through an edge or a corner, wherever the mesh is and whatever its size.
// Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection, explains why this needs care.
#include <gtest/gtest.h>

#include "leaks.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

void expect_tight(const std::string& name, const TriangleMesh& mesh, const Point& inside, float spread, size_t count,
                  size_t fewer) {
    ASSERT_TRUE(mesh.is_closed()) << name << ": not a closed mesh, it proves nothing";
    const ScenePtr scene = shared_scene(scene_of(mesh));
    for (const std::string& accel : Workbench::get().fast_accels())
        for (const int lanes : {16, 1}) {
            Settings settings;
            settings.accel = accel;
            settings.lanes = lanes;
            const Leaks random = random_leaks(scene, inside, spread, settings, accel == "bvh2" && lanes == 16 ? count : fewer),
                        aimed = leaks_among(scene, settings, aimed_at(edges_of(mesh), {inside}));
            const std::string what = name + ", " + accel + ", " + std::to_string(lanes) + " lanes: ";
            EXPECT_EQ(random.count, 0u) << what << random.first;
            EXPECT_EQ(aimed.count, 0u) << what << "aimed at edges and corners: " << aimed.first;
        }
}

TEST(Watertight, TenMillionRaysInASphere) {
    expect_tight("sphere", uv_sphere(1, 200, 120), {0.1f, -0.2f, 0.05f}, 0.3f, 10000000, 1000000);
}

TEST(Watertight, Torus) {
    expect_tight("torus", torus(1, 0.4, 160, 80), {0, 0, 1}, 0.1f, 1000000, 100000);
}

TEST(Watertight, BoxesWithinBoxes) {
    TriangleMesh soup;
    for (int i = 1; i <= 8; ++i) soup.add(box(0.25 * i));
    expect_tight("boxes", soup, {0, 0, 0}, 0.2f, 1000000, 100000);
}

TEST(Watertight, FarFromTheOrigin) {
    TriangleMesh mesh = uv_sphere(1, 100, 60);
    mesh.transform(1, {1e4, -1e4, 1e4});
    expect_tight("sphere at 1e4", mesh, {1e4f, -1e4f, 1e4f}, 0.3f, 1000000, 100000);
}

TEST(Watertight, Tiny) {
    TriangleMesh mesh = torus(1, 0.4, 100, 60);
    mesh.transform(1e-4, {0, 0, 0});
    expect_tight("torus of 1e-4", mesh, {0, 0, 1e-4f}, 1e-5f, 1000000, 100000);
}

TEST(Watertight, TinyAndOffTheOrigin) {
    TriangleMesh mesh = uv_sphere(1, 60, 40);
    mesh.transform(1e-3, {3, 2, -1});
    expect_tight("sphere of 1e-3 at 3", mesh, {3, 2, -1}, 1e-4f, 1000000, 100000);
}

TEST(Watertight, Huge) {
    TriangleMesh mesh = uv_sphere(1, 100, 60);
    mesh.transform(1e6, {0, 0, 0});
    expect_tight("sphere of 1e6", mesh, {0, 0, 0}, 1e5f, 1000000, 100000);
}

TEST(Watertight, Armadillo) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/models/armadillo.obj");
    const ScenePtr scene = load_scene(file);
    TriangleMesh mesh;
    mesh.positions = scene->positions.copy();
    mesh.triangles = scene->triangles.copy();
    const Bounds box = scene->bounds();
    Point inside;
    for (int k = 0; k < 3; ++k) inside[k] = 0.5f * (box.min[k] + box.max[k]);
    expect_tight("armadillo", mesh, inside, 0.01f * box.diagonal(), 1000000, 200000);
}

}  // namespace
