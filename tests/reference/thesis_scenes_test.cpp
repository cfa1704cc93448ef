// thesis_scenes_test.cpp -- compares pictures of the thesis's scenes with the reference: 99.9 % of the pixels are within 2/255.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "reference/difference.hpp"
#include "reference/whitted.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;
using reference::compare;
using reference::Difference;

namespace {

constexpr double kExcepted = .001;  // share of the pixels that may differ: at edges both pictures are right
// In mirrors of mirrors an endless board of squares has edges in most pixels. The offset of ray origins from the surface, in
// single precision, moves one pixel in 700 to the other side of an edge.
constexpr double kExceptedEndless = .002;

class ThesisScenes : public testing::TestWithParam<const char*> {
 protected:
    void SetUp() override {
        scene_ = load_scene(source_file(std::string("scenes/") + GetParam()));
        view_ = make_view(*scene_, 4.0f / 3);
    }

    ByteImage truth(int width, int height, int depth) const {
        return reference::to_display(reference::render(*scene_, view_, settings(width, height, depth)));
    }
    ByteImage ours(int width, int height, int depth) const {
        FrameStats stats;
        ByteImage image = Workbench::get().display(scene_, settings(width, height, depth), view_, &stats);
        EXPECT_EQ(stats.dropped, 0u) << "rays were dropped: the pictures cannot agree";
        return image;
    }

    void expect_agreement(int width, int height, int depth) const {
        const ByteImage a = ours(width, height, depth), b = truth(width, height, depth);
        const Difference d = compare(a, b);
        if (std::getenv("CLARITY_TEST_VERBOSE"))
            std::printf("%s, %d steps: %zu of %zu pixels beyond, worst %d\n", GetParam(), depth, d.beyond, d.pixels, d.worst);
        const double excepted = scene_->planes.empty() ? kExcepted : kExceptedEndless;
        EXPECT_LE(d.share(), excepted) << d.beyond << " of " << d.pixels << " pixels, worst " << d.worst;
        if (d.share() <= excepted) return;
        std::string name = std::string("reference_") + GetParam() + "_" + std::to_string(depth);
        std::replace(name.begin(), name.end(), '/', '_');
        write_image(name + "_ours.png", {}, a);
        write_image(name + "_truth.png", {}, b);
        write_image(name + "_difference.png", {}, d.picture);
        ADD_FAILURE() << "see " << name << "_{ours,truth,difference}.png in the working directory";
    }

 private:
    static Settings settings(int width, int height, int depth) {
        Settings settings;
        settings.width = width;
        settings.height = height;
        settings.depth = depth;
        return settings;
    }

    ScenePtr scene_;
    View view_;
};

TEST_P(ThesisScenes, EqualTheReferenceAtEveryDepth) {
    for (const int depth : {1, 2, 3}) expect_agreement(256, 192, depth);
    expect_agreement(512, 384, 4);
}

// Makes sure that the comparison can fail: every step up to the fourth changes the picture.
TEST_P(ThesisScenes, EveryDepthChangesThePicture) {
    for (const int depth : {1, 2, 3})
        EXPECT_GT(compare(ours(256, 192, depth), ours(256, 192, depth + 1)).share(), kExcepted) << "step " << depth + 1;
}

INSTANTIATE_TEST_SUITE_P(All, ThesisScenes,
                         testing::Values("thesis/1_two_triangles.scene", "thesis/2_two_spheres.scene",
                                         "thesis/3_triangle_two_spheres.scene", "thesis/4_35_triangles.scene",
                                         "thesis/5_36_spheres.scene", "thesis/6_2406_triangles.scene", "spheres21.scene",
                                         "thesis/aim_100k.scene"),
                         [](const auto& info) {
                             std::string name = info.param;
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

// The scenes are as the thesis describes them: their numbers of triangles and spheres, one point
// light, and only materials that mirror or are glass.

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

// Compares rotated, scaled and mirrored meshes with the reference, placed once (flattened) and twice
// (instances). It tests normals, and which side is the inside of glass.

struct Placement {
    const char* name;
    Affine world;
};
// Rows of a rotation about a slanted axis; the columns are scaled by sx, sy, sz.
Affine placed(double sx, double sy, double sz) {
    const double turn[9] = {0.7071068, -0.5, 0.5, 0.5, 0.8535534, 0.1464466, -0.5, 0.1464466, 0.8535534};
    Affine m{};
    for (int row = 0; row < 3; ++row) {
        m[4 * row + 0] = static_cast<float>(turn[3 * row + 0] * sx);
        m[4 * row + 1] = static_cast<float>(turn[3 * row + 1] * sy);
        m[4 * row + 2] = static_cast<float>(turn[3 * row + 2] * sz);
    }
    return m;
}

class Placements : public testing::TestWithParam<const char*> {};

TEST_P(Placements, EqualTheReferencePicture) {
    const ScenePtr model = load_scene(source_file(std::string("scenes/thesis/models/") + GetParam()));
    const Placement placements[] = {{"turned", placed(1, 1, 1)},
                                    {"stretched", placed(.6, 1.3, .8)},
                                    {"mirrored", placed(-1, 1, 1)},
                                    {"tiny and mirrored thrice", placed(-.01, -.012, -.01)}};
    for (const Placement& placement : placements)
        for (const int copies : {1, 2}) {
            Scene scene = *model;
            rt_material crystal = glass(1.5f);
            crystal.refract = .7f;  // some light is scattered, so that errors of normals are visible
            crystal.color[0] = crystal.color[1] = crystal.color[2] = .8f;
            scene.instances[0].material = add_material(scene, crystal);
            scene.instances[0].world_from_object = placement.world;
            if (copies == 2) {  // out of sight, behind the camera
                scene.instances.push_back(scene.instances[0]);
                scene.instances[1].world_from_object[11] = 50;
            }
            const ScenePtr shared = shared_scene(scene);
            const float size = std::string(placement.name).find("tiny") == 0 ? .01f : 1;
            View view = view_from({.3f * size, .4f * size, 4 * size}, {0, 0, 0}, 42);
            view.background = {.1f, .2f, .4f};
            view.ambient = {.1f, .1f, .1f};
            rt_light light{};
            light.position[0] = 2 * size;
            light.position[1] = light.position[2] = 4 * size;
            light.color[0] = light.color[1] = light.color[2] = .9f;
            view.lights = {light};
            Settings settings;
            settings.width = 160;
            settings.height = 120;
            settings.depth = 4;
            const auto d = reference::compare(Workbench::get().display(shared, settings, view),
                                              reference::to_display(reference::render(*shared, view, settings)));
            EXPECT_LE(d.share(), .002) << placement.name << ", " << copies << " times: " << d.beyond << " pixels, worst "
                                       << d.worst;
        }
}

INSTANTIATE_TEST_SUITE_P(All, Placements, testing::Values("ball.obj", "icosahedron.obj"),
                         [](const auto& info) { return std::string(info.param).substr(0, std::string(info.param).find('.')); });

}  // namespace
