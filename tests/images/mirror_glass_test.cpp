// mirror_glass_test.cpp -- compares mirrors, glass, depth and ray arrays with the laws of reflection, Snell and Fresnel.
#include <gtest/gtest.h>

#include <cmath>

#include "images/optics.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

rt_material glowing(float light) {
    rt_material m = diffuse(0, 0, 0);
    m.emission[0] = m.emission[1] = m.emission[2] = light;
    return m;
}

void add_sphere(Scene& scene, const Point& center, float radius, rt_u32 material) {
    Sphere sphere;
    sphere.center = center;
    sphere.radius = radius;
    sphere.material = material;
    scene.spheres.push_back(sphere);
}

void add_polygon(Scene& scene, const std::vector<Point>& corners, rt_u32 material) {
    scene.polygons.push_back(
        {static_cast<rt_u32>(scene.polygon_corners.size() / 3), static_cast<rt_u32>(corners.size()), material});
    for (const Point& p : corners) scene.polygon_corners.insert(scene.polygon_corners.end(), p.begin(), p.end());
}

// A lamp above a floor that mirrors 60 % of the light: its mirror image is as far below the floor.
Scene lamp_over_mirror() {
    Scene scene = scene_of(TriangleMesh());
    scene.planes.push_back({{0, 1, 0}, 0, add_material(scene, mirror(0.6f))});
    add_sphere(scene, {0.3f, 1, -0.5f}, 0.7f, add_material(scene, glowing(1)));
    return scene;
}
View lamp_view() {
    return dark_view({0, 1.5f, 5}, {0, 0, 0}, 50);
}

double lamp_truth(const Ray& line, double share) {
    double margin = 0, mirrored_margin = 0;
    const double direct = hit_sphere({0.3, 1, -0.5}, 0.7, line, &margin),
                 mirrored = hit_sphere({0.3, -1, -0.5}, 0.7, line, &mirrored_margin);
    if (margin < 0.02 || mirrored_margin < 0.02) return -1;
    if (direct < INFINITY) return 1;
    return mirrored < INFINITY && line.direction[1] < 0 ? share : 0;
}

TEST(Mirror, ShowsObjectsAtTheirMirroredPlace) {
    const View view = lamp_view();
    expect_picture(
        trace(lamp_over_mirror(), view, 160, 120, 2), view, [](const Ray& l) { return lamp_truth(l, 0.6); }, 1e-5, 15000);
}

TEST(Mirror, DepthOneShowsNoReflection) {
    const View view = lamp_view();
    const Picture picture = trace(lamp_over_mirror(), view, 160, 120, 1);
    expect_picture(picture, view, [](const Ray& l) { return lamp_truth(l, 0); }, 1e-5, 15000);
    EXPECT_EQ(picture.stats.secondary, 0u);
}

TEST(Mirror, DepthCountsGenerations) {
    // The camera is between two parallel mirrors of 50 %, of which only the one at z = 0 emits light.
    Scene scene = scene_of(TriangleMesh());
    const rt_u32 half = add_material(scene, mirror(0.5f));
    rt_material lit = mirror(0.5f);
    lit.emission[0] = lit.emission[1] = lit.emission[2] = 1;
    scene.planes.push_back({{0, 0, 1}, 0, add_material(scene, lit)});
    scene.planes.push_back({{0, 0, 1}, 4, half});
    const View view = dark_view({0, 0, 2}, {0, 0, 0}, 30);
    double expected = 0;
    for (int depth = 1; depth <= 9; ++depth) {
        if (depth % 2 == 1) expected += std::pow(0.5, depth - 1);  // every other generation hits the bright one
        const Picture picture = trace(scene, view, 9, 9, depth);
        EXPECT_NEAR(picture.at(4, 4)[1], expected, 1e-5) << "depth " << depth;
        EXPECT_EQ(picture.stats.secondary, 81u * (depth - 1));
    }
}

TEST(Mirror, AMeshReflectsLikeAPlane) {
    Scene flat = lamp_over_mirror(), mesh = lamp_over_mirror();
    mesh.planes.clear();
    TriangleMesh floor;
    const rt_u32 a = floor.add_vertex(-50, 0, -50), b = floor.add_vertex(50, 0, -50), c = floor.add_vertex(50, 0, 50),
                 d = floor.add_vertex(-50, 0, 50);
    floor.add_triangle(a, c, b);
    floor.add_triangle(a, d, c);
    const Scene triangles = scene_of(floor);
    mesh.positions = triangles.positions;
    mesh.triangles = triangles.triangles;
    mesh.triangle_materials = {1, 1};
    mesh.meshes = triangles.meshes;
    mesh.instances = triangles.instances;
    const View view = lamp_view();
    expect_picture(trace(mesh, view, 160, 120, 2), view, [](const Ray& l) { return lamp_truth(l, 0.6); }, 1e-5, 15000);
}

TEST(Glass, FresnelAtNormalIncidence) {
    for (const double ior : {1.33, 1.5, 2.4}) {
        Scene scene = scene_of(TriangleMesh());
        const rt_u32 pane = add_material(scene, glass(static_cast<float>(ior))), lamp = add_material(scene, glowing(1));
        add_polygon(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, pane);
        add_polygon(scene, {{-90, -90, 9}, {90, -90, 9}, {90, 90, 9}, {-90, 90, 9}}, lamp);  // behind the eye
        const View view = dark_view({0, 0, 2}, {0, 0, 0}, 0.2);
        const double expected = std::pow((ior - 1) / (ior + 1), 2);
        EXPECT_NEAR(trace(scene, view, 9, 9, 2).at(4, 4)[1], expected, 1e-4) << "ior " << ior;
    }
}

// A pane of thickness 1 in front of the edge of a lamp. The edge appears where Snell's law shifts it to, with the share of
// light that passes both surfaces by Fresnel's equations.
TEST(Glass, SlabShiftsBySnellsLaw) {
    TriangleMesh slab = box(0.5);
    for (size_t i = 0; i < slab.positions.size(); ++i)
        if (i % 3 != 2) slab.positions[i] *= 200;
    Scene scene = scene_of(slab);
    scene.materials[0].values = glass(1.5f);
    add_polygon(scene, {{0, -300, -2}, {300, -300, -2}, {300, 300, -2}, {0, 300, -2}}, add_material(scene, glowing(1)));
    const View view = dark_view({-2, 0.3f, 3}, {0.2f, 0, 0}, 50);
    size_t bright = 0;
    const auto expected = [&](const Ray& line) {
        const Vec n{0, 0, 1};
        const double cos_in = -line.direction[2];
        const Vec within = refracted(line.direction, n, 1 / 1.5);
        const Vec enter = line.at((0.5 - line.origin[2]) / line.direction[2]), leave = enter + (-1 / within[2]) * within;
        const double x = (leave + ((-2 - leave[2]) / line.direction[2]) * line.direction)[0];
        if (std::fabs(x) < 0.01) return -1.0;
        const double passed = (1 - fresnel(cos_in, 1 / 1.5)) * (1 - fresnel(-within[2], 1.5));
        bright += x > 0;
        return x > 0 ? passed : 0.0;
    };
    expect_picture(trace(scene, view, 160, 120, 3), view, expected, 2e-4, 18000);
    EXPECT_GT(bright, 3000u);
    EXPECT_LT(bright, 16000u);
}

// From inside a block of glass, the bright outside is visible up to the critical angle of 41.8 degrees.
TEST(Glass, TotalInternalReflection) {
    Scene scene = scene_of(box(1));
    scene.materials[0].values = glass(1.5f);
    View view = dark_view({0, 0, 0}, {0, 0, -1}, 80);  // the edges of the wall are at 45 degrees, its corners at 55
    view.background = {1, 1, 1};
    size_t total = 0;
    const auto expected = [&](const Ray& line) {
        const Vec p = line.at((-1 - line.origin[2]) / line.direction[2]);
        if (std::fabs(p[0]) > 0.98 || std::fabs(p[1]) > 0.98) return -1.0;  // another wall
        const double cos_in = -line.direction[2], sin2 = 2.25 * (1 - cos_in * cos_in);
        if (std::fabs(sin2 - 1) < 0.02) return -1.0;
        total += sin2 > 1;
        return 1 - fresnel(cos_in, 1.5);
    };
    expect_picture(trace(scene, view, 160, 160, 2), view, expected, 2e-4, 12000);
    EXPECT_GT(total, 500u);
}

TEST(Glass, TintsTransmittedLight) {
    Scene scene = scene_of(TriangleMesh());
    rt_material tinted = glass(1.0f);  // no refraction, no reflection
    tinted.color[0] = 0.5f;
    tinted.color[1] = 0.25f;
    tinted.color[2] = 1;
    add_polygon(scene, {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, add_material(scene, tinted));
    View view = dark_view({0, 0, 2}, {0, 0, 0}, 30);
    view.background = {0.8f, 0.8f, 0.8f};
    const std::array<float, 3> seen = trace(scene, view, 9, 9, 2).at(4, 4);
    EXPECT_NEAR(seen[0], 0.4, 1e-4);
    EXPECT_NEAR(seen[1], 0.2, 1e-4);
    EXPECT_NEAR(seen[2], 0.8, 1e-4);
}

// A ball without losses loses no light: if everything is equally bright, so is the picture through the ball, except for the
// generations that are cut off.
TEST(Glass, ABallInAnEvenlyBrightWorldIsInvisible) {
    Scene scene = scene_of(TriangleMesh());
    add_sphere(scene, {0, 0, 0}, 1, add_material(scene, glass(1.5f)));
    View view = dark_view({0, 0, 5}, {0, 0, 0}, 30);
    view.background = {1, 1, 1};
    // After n reflections inside, the remaining share falls with the n-th power of Fresnel's reflectance. Grazing rays are left
    // out.
    const auto expected = [](const Ray& line) {
        double margin = 0;
        hit_sphere({0, 0, 0}, 1, line, &margin);
        return margin < 0.1 ? -1.0 : 1.0;
    };
    expect_picture(trace(scene, view, 120, 90, 12), view, expected, 1e-3, 5000);
}

TEST(RayArrays, FullArraysDropRaysAndCountThem) {
    Scene scene = scene_of(TriangleMesh());
    rt_material both = glass(1.5f);
    both.reflect = 0.3f;
    both.refract = 0.7f;
    add_sphere(scene, {0, 0, 0}, 1, add_material(scene, both));
    add_sphere(scene, {1.5f, 0, 0}, 1, 1);
    scene.planes.push_back({{0, 1, 0}, -1, add_material(scene, mirror(0.5f))});
    View view = dark_view({0, 0, 5}, {0, 0, 0}, 30);
    view.background = {1, 1, 1};
    const Picture narrow = trace(scene, view, 64, 48, 4, {{"ray_slots", "1"}}),
                  wide = trace(scene, view, 64, 48, 4, {{"ray_slots", "8"}});
    EXPECT_GT(narrow.stats.dropped, 0u);
    EXPECT_EQ(wide.stats.dropped, 0u);
    EXPECT_LT(narrow.stats.secondary, wide.stats.secondary);
    // Dropped rays may only remove light, never add any.
    for (size_t i = 0; i < wide.image.pixels.size(); ++i)
        ASSERT_LE(narrow.image.pixels[i], wide.image.pixels[i] + 1e-4f) << "value " << i;
}

}  // namespace
