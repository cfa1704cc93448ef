// inspect_test.cpp -- the ray tree of a pixel matches the picture. Its light sums up to the pixel's, its rays are those that
// were counted, and its camera ray hits what the AOVs show.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "base/error.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "tracers/inspect/inspect.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

using Kind = RayRecord::Kind;
using Fate = RayRecord::Fate;

Inspector& inspector() {
    static auto* const one = new Inspector(bench().shared_device());  // never destroyed, like the workbench
    return *one;
}

struct Case {
    ScenePtr scene;
    View view;
    Settings settings;
    std::shared_ptr<const Prepared> prepared;
    FloatImage picture;
    FrameStats stats;

    Case(ScenePtr s, View v, Settings chosen) : scene(std::move(s)), view(std::move(v)), settings(std::move(chosen)) {
        prepared = bench().prepare(scene, settings);
        picture = bench().values(scene, settings, view, &stats);
    }
    RayTree tree(unsigned x, unsigned y) const { return inspector().trace(*prepared, settings, view, x, y); }
    FloatImage aov(const std::string& name) const {
        Settings other = settings;
        other.aov = name;
        return bench().values(scene, other, view);
    }
    size_t index(unsigned x, unsigned y) const { return size_t(y) * settings.width + x; }
};

Settings settings_of(const Configuration& configuration, const std::string& size,
                     const std::vector<std::pair<std::string, std::string>>& more = {}) {
    Settings settings = make_settings(more);
    set_setting(settings, "size", size);
    configuration.apply(settings);
    return settings;
}

Case primitives(const Configuration& configuration, const std::string& size,
                const std::vector<std::pair<std::string, std::string>>& more = {}) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    return Case(scene, make_view(*scene, 4.0f / 3), settings_of(configuration, size, more));
}

void expect_light_of_pixel(const Case& c, const RayTree& tree, unsigned x, unsigned y) {
    const float* pixel = &c.picture.pixels[3 * c.index(x, y)];
    for (int k = 0; k < 3; ++k) {
        double sum = 0;
        for (const RayRecord& ray : tree.rays) sum += ray.light[k];
        EXPECT_NEAR(tree.color[k], pixel[k], 1e-6 * pixel[k]) << "pixel " << x << "," << y << " channel " << k;
        if (!tree.truncated) {
            EXPECT_NEAR(sum, pixel[k], 1e-5 * pixel[k] + 1e-9) << "pixel " << x << "," << y << " channel " << k;
        }
    }
}

// Checks what every tree must fulfil.
void expect_sound(const Case& c, const RayTree& tree) {
    ASSERT_FALSE(tree.rays.empty());
    for (size_t i = 0; i < tree.rays.size(); ++i) {
        const RayRecord& ray = tree.rays[i];
        EXPECT_EQ(ray.kind == Kind::camera, i == 0);
        double length = 0;
        for (const float d : ray.direction) length += double(d) * d;
        EXPECT_NEAR(length, 1, 1e-5);
        if (ray.fate != Fate::traced) {
            EXPECT_EQ(ray.prim, -1);
            EXPECT_EQ(ray.steps + ray.leaf_tests, 0u);
        }
        if (i == 0) {
            EXPECT_EQ(ray.parent, -1);
            EXPECT_EQ(ray.generation, 1u);
            continue;
        }
        ASSERT_GE(ray.parent, 0);
        ASSERT_LT(ray.parent, static_cast<int>(i)) << "parents come before their children";
        const RayRecord& parent = tree.rays[ray.parent];
        EXPECT_EQ(parent.fate, Fate::traced) << "the parent was not traced";
        EXPECT_GE(parent.prim, 0) << "the parent hit nothing";
        EXPECT_NE(parent.kind, Kind::shadow);
        EXPECT_EQ(ray.generation, parent.generation + (ray.kind == Kind::shadow ? 0 : 1));
        EXPECT_EQ(ray.light_index >= 0, ray.kind == Kind::shadow);
        if (ray.fate == Fate::too_deep) {
            EXPECT_EQ(ray.generation, unsigned(c.settings.depth) + 1);
        } else if (ray.fate != Fate::too_light) {
            EXPECT_LE(ray.generation, unsigned(c.settings.depth));
        }
        double off = 0, size = 0;
        for (int k = 0; k < 3; ++k) {
            const double at = parent.origin[k] + double(parent.t) * parent.direction[k];
            off = std::max(off, std::fabs(ray.origin[k] - at));
            size = std::max({size, std::fabs(at), double(parent.t)});
            EXPECT_LE(ray.weight[k], parent.weight[k] * 1.0001f);
        }
        EXPECT_LE(off, 1e-4 * size) << "the ray does not start where its parent ended";
        if (ray.kind == Kind::shadow) {
            EXPECT_EQ(ray.weight, parent.weight);
            if (ray.occluded) {
                EXPECT_EQ(ray.light, (std::array<float, 3>{}));
            }
        }
    }
}

// Checks every pixel of a small picture. The trees have as many rays of each kind as the frame counted.
void expect_counted_rays(const Case& c, size_t* dropped = nullptr) {
    uint64_t shadow = 0, secondary = 0, lost = 0;
    for (unsigned y = 0; y < unsigned(c.settings.height); ++y)
        for (unsigned x = 0; x < unsigned(c.settings.width); ++x) {
            const RayTree tree = c.tree(x, y);
            expect_light_of_pixel(c, tree, x, y);
            expect_sound(c, tree);
            for (const RayRecord& ray : tree.rays) {
                lost += ray.fate == Fate::dropped;
                if (ray.fate != Fate::traced) continue;
                shadow += ray.kind == Kind::shadow;
                secondary += ray.kind == Kind::mirror || ray.kind == Kind::refracted;
            }
            if (::testing::Test::HasFailure()) return;  // one pixel's failures are enough to read
        }
    EXPECT_EQ(shadow, c.stats.shadow);
    EXPECT_EQ(secondary, c.stats.secondary);
    EXPECT_EQ(lost, c.stats.dropped);
    EXPECT_GT(secondary, 100u) << "too few rays to prove anything";
    if (dropped) *dropped = lost;
}

TEST(Inspect, RaysOfAllPixelsAddUpToTheFramesCounts) {
    expect_counted_rays(primitives({"bvh2", 16, 4, 4}, "28x21", {{"depth", "6"}}));
}

TEST(Inspect, RaysAddUpForPartlyFilledPacketsAndAnotherStructure) {
    expect_counted_rays(primitives({"spheres", 4, 3, 5}, "22x17", {{"depth", "4"}, {"portable", "true"}}));
}

TEST(Inspect, DroppedRaysAreRecorded) {
    size_t dropped = 0;
    expect_counted_rays(primitives({"bvh2", 16, 4, 4}, "28x21", {{"depth", "8"}, {"ray_slots", "1"}, {"debug", "true"}}),
                        &dropped);
    EXPECT_GT(dropped, 0u);
}

TEST(Inspect, CameraRayAgreesWithTheAovs) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Case c(scene, make_view(*scene, 4.0f / 3, "0,2.5,11,0,2.2,0,50"), settings_of({"bvh2", 16, 4, 4}, "160x120"));
    const FloatImage t = c.aov("t"), prim = c.aov("prim"), instance = c.aov("instance"), steps = c.aov("steps"),
                     tests = c.aov("leaf_tests"), generations = c.aov("generations");
    size_t glass_or_mirror = 0, instanced = 0, nothing = 0;
    for (unsigned y = 1; y < 120; y += 4)
        for (unsigned x = 1; x < 160; x += 4) {
            const RayTree tree = c.tree(x, y);
            const RayRecord& camera = tree.rays.at(0);
            const size_t at = c.index(x, y);
            EXPECT_EQ(camera.prim, prim.pixels[at]) << x << "," << y;
            EXPECT_EQ(camera.instance, instance.pixels[at]) << x << "," << y;
            EXPECT_EQ(camera.steps, steps.pixels[at]) << x << "," << y;
            EXPECT_EQ(camera.leaf_tests, tests.pixels[at]) << x << "," << y;
            unsigned last = 0;
            for (const RayRecord& ray : tree.rays)
                if (ray.fate == Fate::traced) last = std::max(last, ray.generation);
            EXPECT_EQ(last, generations.pixels[at]) << x << "," << y;
            if (std::isinf(t.pixels[at])) {
                EXPECT_TRUE(std::isinf(camera.t));
                ++nothing;
            } else {
                EXPECT_FLOAT_EQ(camera.t, t.pixels[at]) << x << "," << y;
                ASSERT_LT(camera.material, int(c.scene->materials.size()));
                const rt_material& m = c.scene->materials.at(camera.material).values;
                glass_or_mirror += m.reflect + m.refract > 0.5f;
                instanced += camera.instance >= 0;
            }
            expect_light_of_pixel(c, tree, x, y);
        }
    EXPECT_GT(glass_or_mirror, 20u);
    EXPECT_GT(instanced, 20u);
    EXPECT_GT(nothing, 20u);
}

// A mirror before a lamp, straight ahead: every number of the rays is known.
TEST(Inspect, MatchesRaysComputedByHand) {
    Scene scene = scene_of(TriangleMesh());
    scene.planes.push_back({{0, 0, 1}, 0, add_material(scene, mirror(0.5f))});
    rt_material lamp = diffuse(0, 0, 0);
    lamp.emission[0] = 1;
    lamp.emission[1] = 2;
    lamp.emission[2] = 4;
    scene.planes.push_back({{0, 0, -1}, -8, add_material(scene, lamp)});  // z = 8, behind the camera
    View view = view_from({0, 0, 5}, {0, 0, 0}, 40);
    view.ambient = view.background = {0, 0, 0};
    rt_light light{};
    light.position[2] = 6;
    light.color[0] = light.color[1] = light.color[2] = 1;
    view.lights = {light};
    const Case c(shared_scene(scene), view, settings_of({"bvh2", 4, 2, 2}, "3x3", {{"depth", "2"}}));
    const RayTree tree = c.tree(1, 1);
    ASSERT_EQ(tree.rays.size(), 4u);
    EXPECT_EQ(tree.rays[0].kind, Kind::camera);
    EXPECT_NEAR(tree.rays[0].direction[2], -1, 1e-6);
    EXPECT_FLOAT_EQ(tree.rays[0].t, 5);
    EXPECT_EQ(tree.rays[0].material, 1);
    EXPECT_EQ(tree.rays[1].kind, Kind::shadow);
    EXPECT_NEAR(tree.rays[1].t, 6, 1e-3);
    EXPECT_FALSE(tree.rays[1].occluded);
    EXPECT_EQ(tree.rays[2].kind, Kind::mirror);
    EXPECT_NEAR(tree.rays[2].t, 8, 1e-3);
    EXPECT_FLOAT_EQ(tree.rays[2].weight[1], 0.5f);
    EXPECT_EQ(tree.rays[2].light, (std::array<float, 3>{0.5f, 1, 2}));
    EXPECT_EQ(tree.rays[2].material, 2);
    EXPECT_EQ(tree.rays[3].kind, Kind::shadow);
    EXPECT_EQ(tree.rays[3].parent, 2);
    EXPECT_EQ(tree.color, (std::array<float, 3>{0.5f, 1, 2}));
}

TEST(Inspect, UntracedRaysHaveAReason) {
    const auto count = [](const Case& c, Fate fate) {
        const unsigned rows = few_ways() ? 12 : 4;
        size_t n = 0;
        for (unsigned y = 2; y < 48; y += rows)
            for (unsigned x = 2; x < 64; x += 4) {
                const RayTree tree = c.tree(x, y);
                expect_sound(c, tree);
                expect_light_of_pixel(c, tree, x, y);
                for (const RayRecord& ray : tree.rays) n += ray.fate == fate;
            }
        return n * rows / 4;  // as of every fourth row
    };
    const Configuration configuration{"bvh2", 16, 4, 4};
    EXPECT_GT(count(primitives(configuration, "64x48", {{"depth", "1"}}), Fate::too_deep), 20u);
    EXPECT_GT(count(primitives(configuration, "64x48", {{"min_weight", "0.5"}}), Fate::too_light), 20u);
    EXPECT_GT(count(primitives(configuration, "64x48", {{"shadows", "false"}}), Fate::unasked), 100u);
    EXPECT_EQ(count(primitives(configuration, "64x48"), Fate::unasked), 0u);
}

// Spheres of half-mirroring glass inside another one: every hit splits a ray in two.
TEST(Inspect, ATruncatedTreeIsMarked) {
    Scene scene = scene_of(TriangleMesh());
    rt_material both = glass(1.2f);
    both.reflect = both.refract = 0.5f;
    const rt_u32 material = add_material(scene, both);
    for (int i = 0; i < 28; ++i) {
        Sphere sphere;
        sphere.material = material;
        sphere.radius = i == 27 ? 30 : 1;
        if (i < 27) sphere.center = {3.0f * (i % 3) - 3, 3.0f * (i / 3 % 3) - 3, 3.0f * (i / 9) - 3};
        scene.spheres.push_back(sphere);
    }
    View view = view_from({1.5f, 1.4f, 1.3f}, {0, 0, 0}, 40);
    view.background = {0.1f, 0.2f, 0.3f};
    const Case c(shared_scene(scene), view,
                 settings_of({"bvh2", 16, 8, 8}, "1x1", {{"depth", "16"}, {"ray_slots", "64"}, {"min_weight", "0"}}));
    const RayTree tree = c.tree(0, 0);
    EXPECT_TRUE(tree.truncated) << tree.rays.size() << " rays: the test proves nothing";
    EXPECT_EQ(tree.rays.size(), 4096u);
    EXPECT_GT(c.stats.secondary, 4096u);
    expect_light_of_pixel(c, tree, 0, 0);
    expect_sound(c, tree);
}

TEST(Inspect, UsesTheMaterialsOfTheView) {
    Case c = primitives({"bvh2", 16, 4, 4}, "64x48");
    for (const Material& material : c.scene->materials) {
        c.view.materials.push_back(material.values);
        c.view.materials.back().emission[1] += 0.25f;
    }
    const Case edited(c.scene, c.view, c.settings);
    EXPECT_EQ(c.prepared->program, edited.prepared->program);
    size_t brighter = 0;
    for (unsigned y = 1; y < 48; y += 5)
        for (unsigned x = 1; x < 64; x += 5) {
            expect_light_of_pixel(edited, edited.tree(x, y), x, y);
            brighter += edited.picture.pixels[3 * c.index(x, y) + 1] > c.picture.pixels[3 * c.index(x, y) + 1] + 0.2f;
        }
    EXPECT_GT(brighter, 50u);
}

TEST(Inspect, APixelOutsideThePictureIsAnError) {
    const Case c = primitives({"bvh2", 16, 4, 4}, "64x48");
    for (const auto& [x, y] : {std::pair{64u, 0u}, {0u, 48u}, {~0u, ~0u}}) try {
            c.tree(x, y);
            ADD_FAILURE() << x << "," << y;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::usage);
            EXPECT_NE(std::string(error.what()).find("64x48"), std::string::npos) << error.what();
        }
}

// Frames continue while pixels are inspected.
TEST(Inspect, WorksWhileFramesAreTraced) {
    const Case c = primitives({"bvh2", 16, 4, 4}, "64x48");
    const FloatImage picture = c.picture;
    std::atomic<bool> stop{false};
    std::atomic<int> wrong{0}, looked{0};
    std::thread worker([&] {
        for (unsigned i = 0; !stop; ++i, ++looked) {
            const unsigned x = i * 7 % 64, y = i * 5 % 48;
            wrong += c.tree(x, y).color[1] != picture.pixels[3 * c.index(x, y) + 1];
        }
    });
    Progress progress;
    int frames = 0;
    for (; frames < 200 || looked < 20; ++frames) {
        bench().frames().trace(*c.prepared, c.settings, c.view, 0, true, progress);
        wrong += bench().frames().read_values().pixels != picture.pixels;
    }
    stop = true;
    worker.join();
    EXPECT_EQ(wrong, 0) << "of " << frames << " frames and " << looked << " pixels";
}

}  // namespace
