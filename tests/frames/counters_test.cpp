// counters_test.cpp -- the counts of counting programs, against trees with known visits. Counting must not change hits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "picture/film.hpp"
#include "plugin/parameters.hpp"
#include "stand/ray_sets.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

std::vector<std::string> structures() {
    std::vector<std::string> ids = bench().accels();
    ids.erase(std::remove(ids.begin(), ids.end(), "false_counts"), ids.end());  // a plugin of this test
    return ids;
}

std::vector<rt_hit> traced(const ScenePtr& scene, const std::string& accel, int lanes, const std::vector<rt_ray>& rays,
                           RayQuery query) {
    return bench().rays(scene, make_settings({{"accel", accel}, {"lanes", std::to_string(lanes)}}), rays, query);
}

std::vector<rt_hit> counted(const ScenePtr& scene, const std::string& accel, int lanes, const std::vector<rt_ray>& rays,
                            bool any = false) {
    return traced(scene, accel, lanes, rays, {any, true});
}

std::vector<rt_ray> rays_at(double spread, size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> at(-1, 1);
    std::vector<rt_ray> rays;
    for (size_t i = 0; i < count; ++i) {
        const float x = float(spread) * at(random), y = float(spread) * at(random);
        rays.push_back(ray_of({x, y, 5}, {0.1f * x, 0.1f * y, -1}));
    }
    return rays;
}

ScenePtr ball() {
    static const ScenePtr scene = shared_scene(scene_of(uv_sphere(1, 24, 12)));
    return scene;
}

TEST(Counters, LinearTestsEveryPrimitive) {
    const unsigned triangles = static_cast<unsigned>(ball()->triangle_count());
    for (const int lanes : {1, 16}) {
        const std::vector<rt_ray> rays = rays_at(1.5, 64);
        for (const rt_hit& hit : counted(ball(), "linear", lanes, rays)) {
            EXPECT_EQ(hit.steps, 1u);
            EXPECT_EQ(hit.leaf_tests, triangles);
            EXPECT_EQ(hit.lane_steps, unsigned(lanes));
        }
    }
    // Any-hit rays end at their first hit.
    size_t early = 0;
    for (const rt_hit& hit : counted(ball(), "linear", 1, rays_at(0.5, 64), true)) {
        EXPECT_LE(hit.leaf_tests, triangles);
        early += hit.leaf_tests < triangles;
    }
    EXPECT_GT(early, 32u);
}

// A grid names a large polygon in many cells, but a ray tests it once: a traversal of single rays with a mailbox.
TEST(Counters, AMailboxKeepsFromTestingTwice) {
    Scene scene = scene_of(box(0.01));
    for (int i = 0; i < 200; ++i) {  // small ones beside the ray, so that there are cells
        Sphere sphere;
        sphere.center = {0.9f, -1 + 0.01f * float(i), 0.9f};
        sphere.radius = 0.001f;
        scene.spheres.push_back(sphere);
    }
    scene.polygons.push_back({0, 4, 0});
    scene.polygon_corners = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1};
    const rt_plugin& grid = *bench().plugins().accel("grid");
    for (const int lanes : {1, 16}) {
        Settings settings = make_settings({{"accel", "grid"}, {"lanes", std::to_string(lanes)}});
        settings.accel_params = default_parameters(grid);
        set_parameter(grid, settings.accel_params, "density", "3");
        const rt_hit hit =
            bench().rays(shared_scene(scene), settings, {ray_of({-0.9f, -3, -0.999f}, {0, 1, 0})}, {false, true})[0];
        EXPECT_GE(hit.steps, 8u);
        EXPECT_EQ(hit.leaf_tests, 1u);
    }
}

// Spheres, polygons and instanced meshes count as well, planes do not.
TEST(Counters, EveryKindOfPrimitive) {
    Scene scene = scene_of(box(0.5));
    scene.instances.push_back(scene.instances[0]);
    scene.instances.back().world_from_object[3] = 4;  // 4 to the right
    Sphere sphere;
    sphere.center = {0, 3, 0};
    sphere.radius = 0.5f;
    scene.spheres.push_back(sphere);
    scene.planes.push_back({{0, 1, 0}, -9, 0});
    scene.polygons.push_back({0, 3, 0});
    scene.polygon_corners = {0, 5, 0, 1, 5, 0, 0, 6, 0};
    // The second ray meets the farther of the two instances first in the list, and so enters both.
    const std::vector<rt_hit> hits =
        counted(shared_scene(scene), "linear", 1, {ray_of({0, -5, 3}, {0, 0, 1}), ray_of({9, 0, 0}, {-1, 0, 0})});
    EXPECT_EQ(hits[0].steps, 1u) << "the world's list; the ray misses the instances' bounds";
    EXPECT_EQ(hits[0].leaf_tests, 2u);
    EXPECT_EQ(hits[1].steps, 3u) << "the world's list and each instance's";
    EXPECT_EQ(hits[1].leaf_tests, 2u * 12 + 2);
}

TEST(Counters, CountActiveLanesPerNode) {
    for (const std::string& accel : structures()) {
        const rt_ray straight = ray_of({0.1f, 0.2f, 5}, {0, 0, -1});
        const rt_hit alone = counted(ball(), accel, 16, {straight})[0];  // a packet of one ray, visited in a packet's order
        EXPECT_GT(alone.steps, 0u) << accel;
        EXPECT_LE(alone.lane_steps, alone.steps) << accel;
        // Sixteen equal rays: all are active wherever one is.
        for (const rt_hit& hit : counted(ball(), accel, 16, std::vector<rt_ray>(16, straight))) {
            EXPECT_EQ(hit.steps, alone.steps) << accel;
            EXPECT_EQ(hit.leaf_tests, alone.leaf_tests) << accel;
            EXPECT_EQ(hit.lane_steps, 16 * alone.lane_steps) << accel;
        }
        // One active ray, and fifteen with an empty interval.
        std::vector<rt_ray> lonely(16, ray_of({0.1f, 0.2f, 5}, {0, 0, -1}, 0, -1));
        lonely[5] = straight;
        for (const rt_hit& hit : counted(ball(), accel, 16, lonely)) {
            EXPECT_EQ(hit.steps, alone.steps) << accel;
            EXPECT_EQ(hit.lane_steps, alone.lane_steps) << accel;
        }
        // Three rays, in a packet that is not full.
        EXPECT_EQ(counted(ball(), accel, 16, {straight, straight, straight})[0].lane_steps, 3 * alone.lane_steps) << accel;
    }
}

// A packet visits every node that any of its rays would visit. Each ray is counted about where it would go alone. The counts
// may differ, because the visits that a hit saves depend on the packet's order.
TEST(Counters, PacketsAndSingleRaysHaveSimilarCounts) {
    std::vector<rt_ray> rays;
    for (const rt_ray& at : rays_at(1.2, 100))
        for (int i = 0; i < 16; ++i)
            rays.push_back(ray_of({at.origin[0] + 0.01f * (i % 4), at.origin[1] + 0.01f * (i / 4), 5}, {0, 0, -1}));
    const auto alone = counted(ball(), "bvh2", 1, rays), together = counted(ball(), "bvh2", 16, rays);
    uint64_t visits_alone = 0, visits_of_packets = 0, lanes = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(alone[i].lane_steps, alone[i].steps);
        EXPECT_GE(together[i].steps, alone[i].steps) << i;
        EXPECT_LE(together[i].lane_steps, 16 * together[i].steps);
        visits_alone += alone[i].steps;
        if (i % 16) continue;
        visits_of_packets += together[i].steps;
        lanes += together[i].lane_steps;
    }
    EXPECT_LT(visits_of_packets, visits_alone / 2) << "packets share nothing";
    EXPECT_GT(lanes, visits_alone * 95 / 100);
    EXPECT_LT(lanes, visits_alone * 130 / 100);
}

TEST(Counters, CountingChangesNoHit) {
    const std::vector<rt_ray> rays = rays_at(1.5, 1000);
    for (const std::string& accel : structures())
        for (const bool any : {false, true}) {
            const auto plain = traced(ball(), accel, 16, rays, {any, false}), with = counted(ball(), accel, 16, rays, any);
            for (size_t i = 0; i < rays.size(); ++i) {
                EXPECT_EQ(std::memcmp(&plain[i], &with[i], offsetof(rt_hit, steps)), 0) << accel << ", ray " << i;
                EXPECT_EQ(plain[i].steps + plain[i].leaf_tests + plain[i].lane_steps, 0u);
                EXPECT_GT(with[i].steps, 0u);
            }
        }
}

RayWork work_of(const std::string& accel, int lanes, const std::vector<rt_ray>& rays, rt_hit& hit) {
    RayQuery query{false, true};
    std::vector<RayWork> work;
    query.work = &work;
    hit = traced(ball(), accel, lanes, rays, query)[0];
    return work.at(0);
}

// The host's helpers count, whatever a traversal reports or writes to the hit.
TEST(Counters, FalseReportsChangeNoCountOfTheHost) {
    const unsigned triangles = static_cast<unsigned>(ball()->triangle_count());
    for (const int lanes : {1, 16}) {
        rt_hit hit;
        const RayWork work = work_of("false_counts", lanes, rays_at(0.5, 16), hit);
        EXPECT_EQ(hit.steps, 1u);
        EXPECT_EQ(hit.leaf_tests, triangles);
        EXPECT_EQ(work.boxes, 1u);
        EXPECT_EQ(work.own_steps, 0u);
        EXPECT_EQ(work.own_boxes, 0u);
        EXPECT_EQ(work.own_tests, 1000u) << "what it says of itself is kept apart";
    }
}

// A tree of two boxes a node; four that are tested by the plugin itself; planes below one box.
TEST(Counters, BoxesAreTheHostsOrSaidToBeThePlugins) {
    rt_hit hit;
    for (const int lanes : {1, 16}) {
        const RayWork two = work_of("bvh2", lanes, rays_at(0.5, 16), hit);
        EXPECT_EQ(two.boxes, 2 * hit.steps);
        EXPECT_EQ(two.own_boxes + two.own_steps + two.own_tests, 0u);
        const RayWork planes = work_of("kdtree", lanes, rays_at(0.5, 16), hit);
        EXPECT_EQ(planes.boxes, 1u);
        EXPECT_GT(hit.steps, 3u);
    }
    const RayWork four = work_of("bvh4", 1, rays_at(0.5, 16), hit);
    EXPECT_EQ(four.boxes, 0u);
    EXPECT_EQ(four.own_boxes, 4 * hit.steps);
}

TEST(Counters, AovsShowTheCounts) {
    const View view = view_from({0, 0, 5}, {0, 0, 0}, 40);
    const auto picture = [&](const std::string& aov, const std::string& accel, int lanes) {
        return bench().values(
            ball(), make_settings({{"accel", accel}, {"aov", aov}, {"size", "66x50"}, {"lanes", std::to_string(lanes)}}), view);
    };
    const FloatImage tests = picture("leaf_tests", "linear", 16);
    ASSERT_EQ(tests.channels, 1u);
    for (const float value : tests.pixels) EXPECT_EQ(value, float(ball()->triangle_count()));
    for (const float value : picture("lanes", "bvh2", 1).pixels) EXPECT_EQ(value, 1);
    size_t split = 0;
    const FloatImage lanes = picture("lanes", "bvh2", 16);
    for (const float value : lanes.pixels) {
        EXPECT_GT(value, 0);
        EXPECT_LE(value, 1);
        split += value < 0.9f;
    }
    EXPECT_GT(split, 100u);
    const FloatImage steps = picture("steps", "bvh2", 16), boxes = picture("boxes", "bvh2", 16);
    for (size_t i = 0; i < boxes.pixels.size(); ++i) EXPECT_EQ(boxes.pixels[i], 2 * steps.pixels[i]);
    EXPECT_GT(steps.pixels[25 * 66 + 33], steps.pixels[0]);
}

// Returns film.cl's sums over `count` packets that have these four numbers each.
template <class Number>
std::array<uint64_t, 4> summed(FilmKernels& kernels, const std::array<Number, 4>& of_each, unsigned count) {
    std::vector<Number> counters;
    for (unsigned i = 0; i < count; ++i) counters.insert(counters.end(), of_each.begin(), of_each.end());
    const cl::Buffer buffer(bench().shared_device()->context(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
                            counters.size() * sizeof(Number), counters.data());
    kernels.begin_sum(buffer, count,
                      sizeof(Number) == 8 ? FilmKernels::CounterWidth::bits64 : FilmKernels::CounterWidth::bits32);
    KernelTime time;
    return kernels.end_sum(time);
}

TEST(Counters, SumsOfManyRays) {
    FilmKernels kernels(bench().shared_device());
    const uint32_t most = ~0u;
    for (const unsigned count : {1u, 3u, 64u, 65u, 1000u, 100000u}) {
        const auto sums = summed<uint32_t>(kernels, {most, 3000000000u, 7, 0}, count);
        EXPECT_EQ(sums[0], uint64_t(most) * count);
        EXPECT_EQ(sums[1], uint64_t(3000000000u) * count);
        EXPECT_EQ(sums[2], uint64_t(7) * count);
        EXPECT_EQ(sums[3], 0u);
        const uint64_t large = uint64_t(most) << 8 | 0x80u;
        const auto wide = summed<uint64_t>(kernels, {large, most, 0, 1}, count);
        EXPECT_EQ(wide[0], large * count);
        EXPECT_EQ(wide[1], uint64_t(most) * count);
        EXPECT_EQ(wide[2], 0u);
        EXPECT_EQ(wide[3], count);
    }
}

}  // namespace
