// single_ray_test.cpp -- single rays, taken out of their packet and tested against rows of triangles, find bit for bit what
// packets find, which test one triangle after the other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

std::vector<rt_hit> trace(const ScenePtr& scene, const std::string& accel, int lanes, bool portable,
                          const std::vector<rt_ray>& rays, bool any_hit) {
    Settings settings = make_settings({});
    Configuration{accel, lanes, 4, 4}.apply(settings);
    settings.portable = portable;
    return Workbench::get().rays(scene, settings, rays, any_hit);
}

size_t different(const std::vector<rt_hit>& a, const std::vector<rt_hit>& b, bool any_hit) {
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i)
        count += std::memcmp(&a[i], &b[i], any_hit ? sizeof(float) : offsetof(rt_hit, steps)) != 0;
    return count;
}

// Traces each ray in all lanes of a packet of its own. Packets of equal rays are not split into single rays.
std::vector<rt_hit> as_packets(const ScenePtr& scene, const std::vector<rt_ray>& rays, bool any_hit) {
    constexpr size_t lanes = 16;
    std::vector<rt_ray> repeated;
    for (const rt_ray& ray : rays) repeated.insert(repeated.end(), lanes, ray);
    const std::vector<rt_hit> hits = trace(scene, "bvh8", lanes, false, repeated, any_hit);
    std::vector<rt_hit> first;
    for (size_t i = 0; i < rays.size(); ++i) first.push_back(hits[i * lanes]);
    return first;
}

struct Program {
    int lanes;
    bool portable;
};
// Each takes seconds to compile.
const std::vector<Program> kAll = quick() ? std::vector<Program>{{1, false}, {16, false}}
                                          : std::vector<Program>{{1, false}, {16, false}, {1, true}, {8, true}};

void expect_as_packets(const ScenePtr& scene, const std::vector<rt_ray>& rays, size_t least_hits,
                       const std::vector<Program>& programs = kAll) {
    for (const bool any_hit : {false, true}) {
        const std::vector<rt_hit> truth = as_packets(scene, rays, any_hit);
        size_t hits = 0;
        for (const rt_hit& hit : truth) hits += std::isfinite(hit.t);
        EXPECT_GE(hits, least_hits);
        for (const Program& p : programs)
            EXPECT_EQ(different(truth, trace(scene, "bvh8", p.lanes, p.portable, rays, any_hit), any_hit), 0u)
                << p.lanes << " lanes" << (p.portable ? ", portable" : "") << (any_hit ? ", any hit" : "");
    }
}

rt_ray towards(const float* from, const float* to, std::mt19937& random) {
    std::uniform_real_distribution<float> scale(0.1f, 10);
    rt_ray ray{};
    const float s = scale(random);
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = from[k];
        ray.direction[k] = s * (to[k] - from[k]);
    }
    ray.t_max = kInf;
    return ray;
}

TEST(SingleRays, EqualPacketsForRandomRays) {
    std::mt19937 random(12);
    std::uniform_real_distribution<float> at(-1.2f, 1.2f);
    std::vector<rt_ray> rays;
    for (int i = 0; i < 20000; ++i) {
        const float from[3] = {at(random), at(random), at(random)}, to[3] = {at(random), at(random), at(random)};
        rays.push_back(towards(from, to, random));
    }
    expect_as_packets(rubble(), rays, 10000);
}

// Through corners and along edges, where edge functions are zero, and along axes, where products cancel each other.
TEST(SingleRays, EqualPacketsAtCornersEdgesAndAxes) {
    const Scene& scene = *rubble();
    std::mt19937 random(13);
    std::uniform_real_distribution<float> at(-1.2f, 1.2f);
    std::vector<rt_ray> rays;
    for (size_t i = 0; rays.size() < 12000; ++i) {
        const float* const a = &scene.positions[3 * scene.triangles[(3 * i) % scene.triangles.size()]];
        const float* const b = &scene.positions[3 * scene.triangles[(3 * i + 1) % scene.triangles.size()]];
        const float from[3] = {at(random), at(random), at(random)},
                    middle[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
        rays.push_back(towards(from, a, random));
        rays.push_back(towards(from, middle, random));
        if (std::memcmp(a, b, 3 * sizeof(float)) != 0) rays.push_back(towards(a, b, random));  // starts at the corner
        float beside[3] = {a[0], a[1], a[2]};
        beside[i % 3] -= 2;
        rays.push_back(towards(beside, a, random));
    }
    expect_as_packets(rubble(), rays, 6000);
}

// Every kind of primitive that a leaf may hold beside triangles.
TEST(SingleRays, EqualPacketsForEveryKindOfPrimitive) {
    const ScenePtr scene = geometry_of(load_scene(source_file("scenes/primitives.scene")));
    const Bounds box = scene->bounds();
    std::mt19937 random(14);
    std::uniform_real_distribution<float> at(-0.1f, 1.1f);
    const auto point = [&](float* p) {
        for (int k = 0; k < 3; ++k) p[k] = box.min[k] + at(random) * (box.max[k] - box.min[k]);
    };
    std::vector<rt_ray> rays;
    for (int i = 0; i < 10000; ++i) {
        float from[3], to[3];
        point(from), point(to);
        rays.push_back(towards(from, to, random));
    }
    expect_as_packets(scene, rays, 2000, {{1, false}, {16, false}});  // these programs take seconds to compile
}

// Coordinates so large that products overflow, and intervals that contain nothing or everything.
TEST(SingleRays, EqualPacketsForOverflowsAndIntervals) {
    std::mt19937 random(15);
    std::uniform_real_distribution<float> at(-1.2f, 1.2f);
    std::vector<rt_ray> rays;
    for (int i = 0; i < 8000; ++i) {
        const float from[3] = {at(random), at(random), at(random)}, to[3] = {at(random), at(random), at(random)};
        rays.push_back(towards(from, to, random));
        rt_ray& ray = rays.back();
        if (i % 4 == 0) ray.t_max = std::fabs(at(random)) / 4;
        if (i % 4 == 1) ray.t_min = std::fabs(at(random)) / 4;
        if (i % 4 == 2) ray.t_max = -1;
        if (i % 4 == 3)
            for (float& o : ray.origin) o *= 1e18f;
    }
    expect_as_packets(rubble(), rays, 500);

    TriangleMesh mesh;
    for (int i = 0; i < 40; ++i) {
        const double s = std::pow(10.0, i);
        if (s > 1e37) break;
        const rt_u32 a = mesh.add_vertex(-s, -s, -s), b = mesh.add_vertex(s, -s, -s), c = mesh.add_vertex(0, s, -s);
        mesh.add_triangle(a, b, c);
    }
    std::vector<rt_ray> out;
    for (int i = 0; i < 2000; ++i) {
        const float from[3] = {0, 0, 0}, to[3] = {at(random), at(random), -1};
        out.push_back(towards(from, to, random));
    }
    expect_as_packets(shared_scene(scene_of(mesh)), out, 100);
}

}  // namespace
