// thesis_counts_test.cpp -- the scenes are as the thesis describes them: their numbers of triangles and spheres, one point
// light, and only materials that mirror or are glass.
#include <gtest/gtest.h>

#include <set>

#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Expected {
    const char* scene;
    uint64_t triangles;
    size_t spheres, polygons;
};
constexpr Expected kExpected[] = {{"1_two_triangles", 2, 0, 0}, {"2_two_spheres", 0, 2, 0}, {"3_triangle_two_spheres", 1, 2, 0},
                                  {"4_35_triangles", 35, 0, 0}, {"5_36_spheres", 0, 36, 0}, {"6_2406_triangles", 2406, 0, 0},
                                  {"aim_100k", 100002, 1, 2}};

// Materials which the scene's objects use.
std::set<rt_u32> used_materials(const Scene& scene) {
    std::set<rt_u32> used;
    for (const Sphere& sphere : scene.spheres) used.insert(sphere.material);
    for (const Polygon& polygon : scene.polygons) used.insert(polygon.material);
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (rt_u32 i = mesh.first_triangle; i < mesh.first_triangle + mesh.triangle_count; ++i)
            used.insert(instance.material != RT_NONE ? instance.material : scene.triangle_materials[i]);
    }
    return used;
}

TEST(ThesisCounts, EqualThoseOfTheThesis) {
    for (const Expected& expected : kExpected) {
        const ScenePtr scene = load_scene(source_file(std::string("scenes/thesis/") + expected.scene + ".scene"));
        EXPECT_EQ(scene->placed_triangle_count(), expected.triangles) << expected.scene;
        EXPECT_EQ(scene->spheres.size(), expected.spheres) << expected.scene;
        EXPECT_EQ(scene->polygons.size(), expected.polygons) << expected.scene;
        EXPECT_TRUE(scene->planes.empty()) << expected.scene;
        EXPECT_TRUE(scene->warnings.empty()) << expected.scene << ": " << scene->warnings.front();
        ASSERT_EQ(scene->lights.size(), 1u) << expected.scene;
        EXPECT_EQ(scene->lights[0].values.kind, RT_LIGHT_POINT) << expected.scene;
        for (const rt_u32 material : used_materials(*scene)) {
            const Material& m = scene->materials[material];
            EXPECT_GE(m.values.reflect + m.values.refract, .2f) << expected.scene << ": " << m.name;
        }
    }
}

// Every triangle has an area: none was added only to reach the number.
TEST(ThesisCounts, NoTriangleHasZeroArea) {
    for (const char* name : {"4_35_triangles", "6_2406_triangles"}) {
        const ScenePtr scene = load_scene(source_file(std::string("scenes/thesis/") + name + ".scene"));
        for (size_t i = 0; i < scene->triangles.size(); i += 3) {
            double e[2][3];
            for (int k = 0; k < 3; ++k)
                for (int c = 0; c < 2; ++c)
                    e[c][k] = double(scene->positions[3 * scene->triangles[i + size_t(c) + 1] + size_t(k)]) -
                              scene->positions[3 * scene->triangles[i] + size_t(k)];
            const double x = e[0][1] * e[1][2] - e[0][2] * e[1][1], y = e[0][2] * e[1][0] - e[0][0] * e[1][2],
                         z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
            ASSERT_GT(x * x + y * y + z * z, 1e-12) << name << ", triangle " << i / 3;
        }
    }
}

}  // namespace
