// variants_test.cpp -- the same kernels without CPU instructions, and with every stack watched.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "unit/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

Workbench& bench() {
    return Workbench::get();
}

FloatImage picture(const ScenePtr& scene, const View& view, const Configuration& configuration, const std::string& aov,
                   bool portable, bool debug, FrameStats* stats = nullptr) {
    Settings settings = make_settings({{"size", "160x120"}, {"depth", "5"}, {"aov", aov}});
    configuration.apply(settings);
    settings.portable = portable;
    settings.debug = debug;
    return bench().values(scene, settings, view, stats);
}

size_t different_bits(const FloatImage& a, const FloatImage& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) count += std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(float)) != 0;
    return count;
}

TEST(Variants, FallbacksGiveTheSameBits) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    for (const Configuration& configuration :
         {Configuration{"bvh2", 4, 4, 4}, Configuration{"spheres", 8, 3, 5}, Configuration{"bvh2", 16, 4, 4}}) {
        const FloatImage fast = picture(scene, view, configuration, "t", false, false),
                         plain = picture(scene, view, configuration, "t", true, false);
        ASSERT_EQ(fast.pixels.size(), 160u * 120u);
        EXPECT_EQ(different_bits(fast, plain), 0u) << configuration.text() << ", t";
    }
    for (const int lanes : {4, 8, 16}) {
        const Configuration configuration{"bvh2", lanes, 4, 4};
        const FloatImage fast = picture(scene, view, configuration, "color", false, false),
                         plain = picture(scene, view, configuration, "color", true, false);
        size_t differ = 0;
        for (size_t i = 0; i < fast.pixels.size(); ++i) differ += !(std::fabs(fast.pixels[i] - plain.pixels[i]) <= 1e-3f);
        EXPECT_EQ(differ, 0u) << configuration.text() << ", colour";
    }
}

void expect_no_overflow(const ScenePtr& scene, const std::string& name, const std::vector<std::string>& accels) {
    const View view = make_view(*scene, 4.0f / 3);
    for (const std::string& accel : accels) {
        const Configuration configuration{accel, 16, 4, 4};
        FrameStats stats;
        const FloatImage watched = picture(scene, view, configuration, "color", false, true, &stats);
        EXPECT_EQ(stats.overflowed, 0u) << name << ", " << configuration.text();
        if (accel == accels.front()) {
            EXPECT_EQ(different_bits(watched, picture(scene, view, configuration, "color", false, false)), 0u)
                << name << ", " << configuration.text() << ": watching changes the picture";
        }
    }
}

TEST(Debug, NoStackOverflowsOnRealScenes) {
    expect_no_overflow(load_scene(source_file("scenes/primitives.scene")), "primitives", bench().accels());
    expect_no_overflow(load_scene(source_file("scenes/showpiece.scene")), "showpiece", bench().fast_accels());
}

TEST(Debug, NoStackOverflowsOnTheDragon) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/models/dragon_res3.ply");
    expect_no_overflow(load_scene(file), "dragon", bench().fast_accels());
}

// Sizes that double from triangle to triangle make trees as deep as they get.
TEST(Debug, NoStackOverflowsOnTheDeepestTrees) {
    TriangleMesh mesh;
    for (int i = 0; i < 100; ++i) {
        const double s = std::pow(2.0, -0.5 * i);
        const rt_u32 a = mesh.add_vertex(s, 0, 0), b = mesh.add_vertex(s * 1.2, s, 0), c = mesh.add_vertex(s * 1.2, 0, s);
        mesh.add_triangle(a, b, c);
    }
    for (int i = 0; i < 2000; ++i) {  // and many at one place
        const rt_u32 a = mesh.add_vertex(0.5, 0.5, 0), b = mesh.add_vertex(0.6, 0.5, 0), c = mesh.add_vertex(0.5, 0.6, 0);
        mesh.add_triangle(a, b, c);
    }
    expect_no_overflow(shared_scene(scene_of(mesh)), "doubling triangles", bench().accels());
}

// The watch itself works: bvh2's traversal with a stack of two entries must say that they are too few, and still end.
TEST(Debug, AFullStackIsCounted) {
    Scratch scratch;
    Environment environment;
    std::filesystem::copy(source_file("cl"), scratch.path("cl"), std::filesystem::copy_options::recursive);
    std::ifstream in(source_file("plugins/accel/bvh2/bvh2.cl"));
    const std::string traversal{std::istreambuf_iterator<char>(in), {}};
    scratch.write("plugins/accel/bvh2/bvh2.cl", "#undef BVH2_STACK\n#define BVH2_STACK 2u\n" + traversal);
    environment.set("CLARITY_KERNEL_PATH", scratch.path("cl"));
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    FrameStats stats;
    picture(scene, make_view(*scene, 4.0f / 3), {"bvh2", 16, 4, 4}, "color", false, true, &stats);
    EXPECT_GT(stats.overflowed, 0u);
}

}  // namespace
