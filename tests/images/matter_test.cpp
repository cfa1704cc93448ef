// matter_test.cpp -- what files say of matter, against closed forms: colours of vertices.
#include <gtest/gtest.h>

#include <cmath>

#include "images/optics.hpp"
#include "images/path_checks.hpp"
#include "render/kernels/scene_features.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A square with corners at (-1,-1) and (1,1) at a depth z.
void add_square(Scene& scene, float z, rt_u32 material) {
    const rt_u32 first = scene.vertex_count();
    for (const auto& [x, y] : {std::pair(-1.f, -1.f), std::pair(1.f, -1.f), std::pair(1.f, 1.f), std::pair(-1.f, 1.f)})
        for (const float p : {x, y, z}) scene.positions.push_back(p);
    Mesh mesh;
    mesh.first_vertex = first;
    mesh.vertex_count = 4;
    mesh.first_triangle = scene.triangle_count();
    mesh.triangle_count = mesh.polygon_count = 2;
    for (const rt_u32 corner : {0u, 1u, 2u, 0u, 2u, 3u}) scene.triangles.push_back(first + corner);
    scene.triangle_materials.resize(scene.triangle_count(), material);
    Instance instance;
    instance.mesh = static_cast<rt_u32>(scene.meshes.size());
    scene.instances.push_back(instance);
    scene.meshes.push_back(mesh);
}

// Whitted's ambient light of 1, and for `path` a sky of 1: a diffuse surface shows its colour. The picture is the square at z =
// 0.
View even_view() {
    View view = view_from({0, 0, 5}, {0, 0, 0}, 2 * std::atan(1.0 / 5) * 180 / 3.14159265358979);
    view.background = view.ambient = {1, 1, 1};
    return view;
}

// Corners are red, green, blue and white; the material halves them.
Scene colored_square(const Affine& placed = kIdentity) {
    Scene scene;
    scene.materials.assign(1, Material{"", diffuse(0.5f, 0.5f, 0.5f)});
    add_square(scene, 0, 0);
    scene.colors = {1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1};
    scene.instances[0].world_from_object = placed;
    return scene;
}
// x, y: 0..1 from the lower left corner. The square is the triangles red, green, blue and red, blue, white.
std::array<double, 3> color_at(double x, double y) {
    if (y <= x) return {1 - x, x - y, y};
    return {1 - x, y - x, y};
}

void expect_colors(const FloatImage& image, double room) {
    for (unsigned y = 2; y < image.height; y += 5)
        for (unsigned x = 1; x < image.width; x += 5) {
            const double u = (x + 0.5) / image.width, v = 1 - (y + 0.5) / image.height;
            const std::array<double, 3> wanted = color_at(u, v);
            for (unsigned k = 0; k < 3; ++k)
                ASSERT_NEAR(image.pixels[3 * (size_t(y) * image.width + x) + k], 0.5 * wanted[k], room)
                    << x << "," << y << " " << k;
        }
}

TEST(VertexColors, AreInterpolatedAndMultiplyTheMaterial) {
    for (const char* tracer : {"iterative", "wavefront"})
        for (const char* lanes : {"1", "8"})
            expect_colors(trace(colored_square(), even_view(), 64, 64, 1, {{"tracer", tracer}, {"lanes", lanes}}).image, 1e-4);
    for (const char* lanes : {"1", "4"}) {
        // Rays that the surface scatters find the sky everywhere, so only places within a pixel differ.
        const PathPicture picture = trace_paths(colored_square(), even_view(), 16, {{"strategy", "bsdf"}, {"lanes", lanes}});
        expect_colors(picture.mean, 0.006);
    }
}

// Larger by 2 about the middle, and apart, so that the structure has an instance.
TEST(VertexColors, StayWithTheirInstance) {
    Scene scene = colored_square({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0});
    scene.instances[0].apart = true;
    View view = view_from({0, 0, 10}, {0, 0, 0}, 2 * std::atan(1.0 / 5) * 180 / 3.14159265358979);
    view.ambient = {1, 1, 1};
    expect_colors(trace(scene, view, 64, 64, 1).image, 1e-4);
}

TEST(VertexColors, OnlyScenesThatHaveThemPayForThem) {
    Scene scene = colored_square();
    BuildScene build;
    build.attribute_triangle.resize(2);
    EXPECT_TRUE(features_of(scene, build).colors);
    scene.colors = {};
    EXPECT_FALSE(features_of(scene, build).colors);
}

}  // namespace
