// variants_test.cpp -- the same kernels without CPU instructions, and with bounds checks of every stack.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/log.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"
#include "tracers/inspect/inspect.hpp"
#include "tracers/rays/ray_blocks.hpp"
#include "view/settings/aov.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

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
                << name << ", " << configuration.text() << ": bounds checks change the picture";
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

// Sizes that double from triangle to triangle make the deepest trees.
TEST(Debug, NoStackOverflowsOnTheDeepestTrees) {
    TriangleMesh mesh;
    for (int i = 0; i < 100; ++i) {
        const double s = std::pow(2.0, -0.5 * i);
        const rt_u32 a = mesh.add_vertex(s, 0, 0), b = mesh.add_vertex(s * 1.2, s, 0), c = mesh.add_vertex(s * 1.2, 0, s);
        mesh.add_triangle(a, b, c);
    }
    for (int i = 0; i < 2000; ++i) {  // and many triangles at one place
        const rt_u32 a = mesh.add_vertex(0.5, 0.5, 0), b = mesh.add_vertex(0.6, 0.5, 0), c = mesh.add_vertex(0.5, 0.6, 0);
        mesh.add_triangle(a, b, c);
    }
    expect_no_overflow(shared_scene(scene_of(mesh)), "doubling triangles", bench().accels());
}

// Kernels in which the traversal stack of a structure has two entries.
class SmallStack {
 public:
    explicit SmallStack(const std::string& accel, const std::string& macro) {
        std::filesystem::copy(source_file("cl"), scratch_.path("cl"), std::filesystem::copy_options::recursive);
        const std::string file = "plugins/accel/" + accel + "/" + accel + ".cl";
        std::ifstream in(source_file(file));
        const std::string traversal{std::istreambuf_iterator<char>(in), {}};
        scratch_.write(file, "#undef " + macro + "\n#define " + macro + " 2u\n" + traversal);
        environment_.set("CLARITY_KERNEL_PATH", scratch_.path("cl"));
    }

 private:
    Scratch scratch_;
    Environment environment_;
};

// The check itself works: bvh2's traversal with a stack of two entries must report overflows, and still end.
TEST(Debug, AFullStackIsCounted) {
    const SmallStack small("bvh2", "BVH2_STACK");
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    FrameStats stats;
    picture(scene, make_view(*scene, 4.0f / 3), {"bvh2", 16, 4, 4}, "color", false, true, &stats);
    EXPECT_GT(stats.overflowed, 0u);
}

// Every picture traces the same camera rays, whatever quantity it shows.
TEST(Debug, AFullStackIsCountedForEveryAov) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    const auto overflowed = [&](const std::string& aov) {
        FrameStats stats;
        picture(scene, view, {"bvh2", 16, 4, 4}, aov, false, true, &stats);
        return stats.overflowed;
    };
    EXPECT_EQ(overflowed("t"), 0u) << "with the stack that the builder asked for";
    const SmallStack small("bvh2", "BVH2_STACK");
    const uint64_t of_camera_rays = overflowed("t");
    EXPECT_GT(of_camera_rays, 0u);
    EXPECT_EQ(overflowed("t"), of_camera_rays) << "each picture starts at 0";
    for (const std::string& aov : find_setting("aov")->choices) {
        const bool spawns = find_aov(aov).adds_samples() || aov == "generations";
        if (spawns)
            EXPECT_GE(overflowed(aov), of_camera_rays) << aov;
        else
            EXPECT_EQ(overflowed(aov), of_camera_rays) << aov;
    }
}

// Collects errors of the log during its lifetime.
class Listener {
 public:
    Listener() {
        set_log_listener([this](LogLevel level, const std::string& text) {
            if (level == LogLevel::error) errors_ += text + "\n";
        });
    }
    ~Listener() { set_log_listener({}); }
    std::string take() { return std::exchange(errors_, {}); }

 private:
    std::string errors_;
};

// The caller's own rays, by each kernel that traces them, and the inspector's rays.
TEST(Debug, AFullStackOfRayQueriesIsReported) {
    const ScenePtr scene = shared_scene(scene_of(uv_sphere(1, 48, 24)));
    const View view = view_from({0, 0, 5}, {0, 0, 0}, 40);
    std::vector<rt_ray> rays;
    for (int i = 0; i < 4096; ++i)
        rays.push_back({{0, 0, 5}, 0, {0.005f * float(i % 64 - 32), 0.005f * float(i / 64 - 32), -1}, INFINITY});
    Listener listener;
    const auto watched = [&](const std::string& accel, const char* lanes) {
        Settings settings = make_settings({{"accel", accel}, {"lanes", lanes}, {"debug", "true"}, {"size", "64x48"}});
        if (std::string(lanes) == "1") set_setting(settings, "packet", "1x1"), set_setting(settings, "portable", "true");
        const auto prepared = bench().prepare(scene, settings);
        std::string silent;
        // The autotuner tries the variants in turn, so that six runs cover all.
        for (const RayQuery query : {RayQuery{false, false}, RayQuery{true, false}, RayQuery{false, true}}) {
            const RayBlocks packed(rays, unsigned(settings.lanes));
            for (int run = 0; run < (query.count ? 1 : 6); ++run) {
                bench().queries().trace(*prepared, packed, query);
                if (listener.take().find("stack") == std::string::npos) silent += accel + " " + lanes + "; ";
            }
        }
        return silent;
    };
    EXPECT_NE(watched("bvh2", "16"), "");
    EXPECT_EQ(listener.take(), "");
    {
        const SmallStack small("bvh2", "BVH2_STACK");
        EXPECT_EQ(watched("bvh2", "16"), "");
    }
    {
        const SmallStack small("bvh4", "BVH4_STACK");
        EXPECT_EQ(watched("bvh4", "1"), "");
    }
    const Settings settings = make_settings({{"accel", "bvh2"}, {"debug", "true"}, {"size", "64x48"}});
    Inspector inspector(bench().shared_device());
    EXPECT_EQ(inspector.trace(*bench().prepare(scene, settings), settings, view, 32, 24).overflowed, 0u);
    EXPECT_EQ(listener.take(), "");
    const SmallStack small("bvh2", "BVH2_STACK");
    EXPECT_GT(inspector.trace(*bench().prepare(scene, settings), settings, view, 32, 24).overflowed, 0u);
    EXPECT_NE(listener.take().find("stack"), std::string::npos);
}

}  // namespace
