// rays_test.cpp -- rays of the caller: nearest and any hit, the limits of rays, and directions that no camera makes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <set>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "conformance/compare.hpp"
#include "conformance/degenerate.hpp"
#include "stand/ray_sets.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

Settings settings_of(const std::string& accel, int lanes) {
    Settings settings;
    settings.accel = accel;
    settings.lanes = lanes;
    return settings;
}

void expect_as_oracle(const ScenePtr& scene, const Oracle& oracle, const std::vector<rt_ray>& rays, const std::string& accel,
                      int lanes, size_t allowed, bool portable = false) {
    Settings settings = settings_of(accel, lanes);
    settings.portable = portable;
    const std::vector<rt_hit> closest = bench().rays(scene, settings, rays, false),
                              any = bench().rays(scene, settings, rays, true);
    ASSERT_EQ(closest.size(), rays.size());
    ASSERT_EQ(any.size(), rays.size());
    std::vector<Truth> truth;
    std::vector<Ray> wide;
    FloatPixels t, prims;
    size_t contradictions = 0, outside = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        wide.push_back(widened(rays[i]));
        truth.push_back(oracle.closest(wide.back()));
        t.push_back(closest[i].t);
        prims.push_back(static_cast<float>(closest[i].prim));
        contradictions += std::isfinite(closest[i].t) != (any[i].t == 0);
        outside += std::isfinite(t[i]) && (t[i] < rays[i].t_min || t[i] > rays[i].t_max);
    }
    const Comparison c = compare(oracle, truth, wide, t, &prims);
    const std::string what = accel + ", " + std::to_string(lanes) + " lanes: " + c.text();
    EXPECT_GT(c.hits, c.rays / 50) << what;
    EXPECT_LE(c.wrong(), allowed) << what;
    EXPECT_EQ(c.other_prim, 0u) << what;
    EXPECT_EQ(contradictions, 0u) << what << ": any hit and nearest hit contradict each other";
    EXPECT_EQ(outside, 0u) << what << ": hits outside t_min..t_max";
    if (std::getenv("CLARITY_TEST_VERBOSE")) std::printf("%s\n", what.c_str());
}

void expect_everywhere(const ScenePtr& scene, const Oracle& oracle, const std::vector<rt_ray>& rays, size_t allowed) {
    for (const std::string& accel : bench().accels())
        for (const int lanes : lane_counts(accel)) expect_as_oracle(scene, oracle, rays, accel, lanes, allowed);
}

// A sphere, a torus and boxes that touch: few triangles, so that `linear`, which tests all of them, is fast enough.
ScenePtr shapes() {
    static const ScenePtr scene = [] {
        TriangleMesh mesh = uv_sphere(1, 24, 16), ring = torus(1.6, 0.3, 24, 12), cube = box(0.5);
        mesh.add(ring);
        for (int i = 0; i < 3; ++i) {
            cube.transform(1, {i == 0 ? -3.0 : 1.0, i == 0 ? -2.0 : 0.0, 0});
            mesh.add(cube);
        }
        return shared_scene(scene_of(mesh));
    }();
    return scene;
}

TEST(Rays, RandomRaysOnShapes) {
    const Oracle oracle(shapes());
    expect_everywhere(shapes(), oracle, random_rays(shapes()->bounds(), 20000, 1), 0);
}

#ifdef __SSE__
// Embree leaves its threads in a mode which flushes denormals to zero, also small indices in lanes of float vectors. Builders
// must work if they are called in that mode.
TEST(Rays, NoPrimitiveIsLostWhereDenormalsAreFlushed) {
    const unsigned before = _mm_getcsr();
    for (const std::string& accel : bench().accels()) {
        const auto fresh = std::make_shared<const Scene>(*shapes());  // a new scene, so that the structure is built again
        _mm_setcsr(before | 0x8040);
        const auto prepared = bench().prepare(fresh, settings_of(accel, lane_counts(accel).front()));
        _mm_setcsr(before);
        const auto* leaves = static_cast<const rt_packed_prim*>(prepared->accel->leaves.data());
        std::set<rt_u32> refs;
        for (uint64_t i = 0; i < prepared->accel->leaf_count; ++i) refs.insert(leaves[i].ref);
        EXPECT_EQ(refs.size(), prepared->accel->scene.attribute_triangle.size()) << accel;
    }
}
#endif

// One lane and `portable`: the kernel variant for GPUs, tested on any device.
TEST(Rays, OneLaneAndPortable) {
    for (const ScenePtr& scene : {shapes(), geometry_of(load_scene(source_file("scenes/primitives.scene")))}) {
        const Oracle oracle(scene);
        for (const std::string& accel : bench().accels())
            expect_as_oracle(scene, oracle, random_rays(scene->bounds(), 20000, 9), accel, 1, 0, true);
    }
}

TEST(Rays, RandomRaysOnEveryPrimitive) {
    const ScenePtr scene = geometry_of(load_scene(source_file("scenes/primitives.scene")));
    const Oracle oracle(scene);
    for (const std::string& accel : bench().accels())
        expect_as_oracle(scene, oracle, random_rays(scene->bounds(), 20000, 2), accel, 16, 0);
}

TEST(Rays, RandomRaysOnTheBunny) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/models/bunny.ply");
    const ScenePtr scene = geometry_of(load_scene(file));
    const Oracle oracle(scene);
    for (const std::string& accel : bench().fast_accels())
        for (const int lanes : {1, 16})
            expect_as_oracle(scene, oracle, random_rays(scene->bounds(), quick() ? 50000 : 200000, 3), accel, lanes,
                             quick() ? 1 : 2);
}

TEST(Rays, HitsAreWithinTheirInterval) {
    std::vector<rt_ray> rays = random_rays(shapes()->bounds(), 20000, 4);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> t(0, 4);
    for (rt_ray& ray : rays) {
        const float a = t(random), b = t(random);
        ray.t_min = std::min(a, b);
        ray.t_max = std::max(a, b);
    }
    expect_everywhere(shapes(), Oracle(shapes()), rays, 0);
}

// Rays from far away, where the coordinates of neighbouring surfaces agree in most digits. Half of them are aimed at the scene,
// half pass it at any distance, up to a million times the size of a triangle.
TEST(Rays, FromFarAway) {
    const ScenePtr scene = geometry_of(load_scene(source_file("scenes/primitives.scene")));
    const Oracle oracle(scene);
    std::vector<rt_ray> rays = random_rays(scene->bounds(), 20000, 9);
    std::mt19937 random(10);
    std::uniform_real_distribution<float> decades(1, 5), one(-1, 1);
    for (size_t i = 0; i < rays.size(); ++i) {
        rt_ray& ray = rays[i];
        const float far = std::pow(10.0f, decades(random));
        if (i % 2) {
            // Origins along the floor, directions to a lamp in the sky.
            ray = ray_of({far * one(random), 0.7f, far * one(random)}, {0.486664265f, 0.811107099f, 0.324442834f});
            continue;
        }
        const float* d = ray.direction;
        const float length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int k = 0; k < 3; ++k) ray.origin[k] -= std::min(far, 1e4f) / length * d[k];
        ray.origin[1] = std::fabs(ray.origin[1]);  // above the floor
    }
    for (const std::string& accel : quick() ? bench().fast_accels() : bench().accels())
        expect_as_oracle(scene, oracle, rays, accel, 16, 0);
}

TEST(Rays, AlongTheAxes) {
    std::mt19937 random(6);
    std::uniform_real_distribution<float> at(-2.5f, 2.5f);
    std::vector<rt_ray> rays;
    for (int i = 0; i < 12000; ++i) {
        const Point origin{at(random), at(random), at(random)};
        Point direction{};
        // Directions along one axis or two; the zeros have either sign.
        for (float& d : direction) d = random() & 1 ? 0.0f : -0.0f;
        direction[i % 3] = i & 8 ? 1.0f : -1.0f;
        if (i % 2) direction[(i + 1) % 3] = at(random);
        rays.push_back(ray_of(origin, direction));
    }
    expect_everywhere(shapes(), Oracle(shapes()), rays, 0);
}

// Origins in the planes of the boxes with directions in these planes, and rays that hit corners exactly. There are ties, so the
// test only asks that structures agree with each other and with their own any-hit queries.
TEST(Rays, AtCornersAndAlongFaces) {
    std::vector<rt_ray> rays;
    const ScenePtr scene = shared_scene(degenerate_scene());
    for (int x = -6; x <= 6; ++x)
        for (int y = -6; y <= 6; ++y) {
            rays.push_back(ray_of({0.5f * x, 0.5f * y, 6}, {0, 0, -1}));
            rays.push_back(ray_of({6, 0.5f * x, 0.5f * y}, {-1, 0, 0}));
            rays.push_back(ray_of({0.5f * x, 6, 0.5f * y}, {0, -1, 0}));
        }
    for (const std::string& accel : few_ways() ? bench().fast_accels() : bench().accels()) {
        const std::vector<rt_hit> one = bench().rays(scene, settings_of(accel, 1), rays, false);
        for (const int lanes : {1, 16}) {
            const std::vector<rt_hit> closest = bench().rays(scene, settings_of(accel, lanes), rays, false),
                                      any = bench().rays(scene, settings_of(accel, lanes), rays, true);
            for (size_t i = 0; i < rays.size(); ++i) {
                EXPECT_EQ(std::isfinite(closest[i].t), any[i].t == 0) << accel << ", " << lanes << " lanes, ray " << i;
                if (std::isfinite(one[i].t) || std::isfinite(closest[i].t)) {
                    EXPECT_FLOAT_EQ(closest[i].t, one[i].t) << accel << ", " << lanes << " lanes, ray " << i;
                }
            }
        }
    }
}

// The rule of CONTRACT.md: a direction is finite, and a component is at least 2^-60.
bool is_direction(const float* d) {
    float most = 0;
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(d[k])) return false;
        most = std::max(most, std::fabs(d[k]));
    }
    return most >= 0x1p-60f;
}

// Shapes, and a box with a corner at 0; rays at them, also along axes, within planes of two, and within the box's faces at 0.
ScenePtr shapes_at_zero(double scale) {
    TriangleMesh mesh = uv_sphere(1, 24, 16), cube = box(0.5);
    mesh.transform(1, {2.5, 1, -3});
    cube.transform(1, {0.5, 0.5, 0.5});
    mesh.add(cube);
    mesh.transform(scale, {0, 0, 0});
    return shared_scene(scene_of(mesh));
}

std::vector<rt_ray> rays_at_zero() {
    std::vector<rt_ray> rays = random_rays(shapes_at_zero(1)->bounds(), 300, 21);
    for (const float zero : {0.f, -0.f})
        for (const float other : {0.f, -0.f})
            for (const float sign : {1.f, -1.f})
                for (int k = 0; k < 3; ++k)
                    for (const Point& along : {Point{0, 0.25f, 0}, Point{0.25f, 0, 0}, Point{0, 0, 0}, Point{0.75f, 0.125f, 0}})
                        for (const float slope : {0.f, 0.125f}) {
                            Point from{}, d{};
                            from[k] = -5 * sign, from[(k + 1) % 3] = along[0], from[(k + 2) % 3] = along[1];
                            d[k] = sign, d[(k + 1) % 3] = zero, d[(k + 2) % 3] = slope != 0 ? slope : other;
                            if (slope != 0) from[(k + 2) % 3] -= 5 * slope;
                            rays.push_back(ray_of(from, d));
                        }
    return rays;
}

size_t count_hits(const std::vector<rt_hit>& hits) {
    return static_cast<size_t>(std::count_if(hits.begin(), hits.end(), [](const rt_hit& hit) { return hit.prim >= 0; }));
}

// A ray hits the same by a direction of any length, and t is in that length. Powers of two are exact, so not a bit differs.
TEST(Rays, DirectionsOfAnyLength) {
    const ScenePtr scene = shapes_at_zero(1);
    const std::vector<rt_ray> rays = rays_at_zero();
    for (const std::string& accel : bench().accels())
        for (const int lanes : lane_counts(accel)) {
            const Settings settings = settings_of(accel, lanes);
            const std::vector<rt_hit> unit = bench().rays(scene, settings, rays, false);
            EXPECT_GT(count_hits(unit), rays.size() / 4);
            for (const int power : {-60, -59, -40, -20, 9, 20, 60, 110}) {
                std::vector<rt_ray> scaled = rays;
                for (size_t i = 0; i < scaled.size(); ++i) {
                    if (i % 7 == 3) continue;  // usual lengths beside others
                    for (float& d : scaled[i].direction) d = std::ldexp(d, power);
                    scaled[i].t_max = std::ldexp(100.f, -power);
                }
                const std::vector<rt_hit> closest = bench().rays(scene, settings, scaled, false),
                                          any = bench().rays(scene, settings, scaled, true);
                size_t wrong = 0;
                for (size_t i = 0; i < rays.size(); ++i) {
                    const float t = i % 7 == 3 ? closest[i].t : std::ldexp(closest[i].t, power);
                    if (!is_direction(scaled[i].direction))
                        wrong += closest[i].prim >= 0 || any[i].t == 0;
                    else
                        wrong += t != unit[i].t || closest[i].prim != unit[i].prim || (any[i].t == 0) != (unit[i].prim >= 0);
                }
                EXPECT_EQ(wrong, 0u) << accel << ", " << lanes << " lanes, directions of 2^" << power;
            }
        }
}

// What is hit does not depend on the unit of length, from 1e-14 to nearly 1e15. Rays within faces at 0 are the hard ones: at
// 2^40 units from there boxes lost them, products of three lengths overflowed at 2^42 and lost their digits at 2^-44.
TEST(Rays, ScenesOfAnySize) {
    const std::vector<rt_ray> rays = rays_at_zero();
    for (const std::string& accel : bench().accels())
        for (const int lanes : {lane_counts(accel).front()}) {  // each scale and number of lanes is a program
            const Settings settings = settings_of(accel, lanes);
            const std::vector<rt_hit> unit = bench().rays(shapes_at_zero(1), settings, rays, false);
            for (const int power : {-46, 20, 36, 46}) {
                std::vector<rt_ray> scaled = rays;
                for (rt_ray& ray : scaled)
                    for (float& x : ray.origin) x = std::ldexp(x, power);
                const ScenePtr scene = shapes_at_zero(std::ldexp(1.0, power));
                const std::vector<rt_hit> closest = bench().rays(scene, settings, scaled, false),
                                          any = bench().rays(scene, settings, scaled, true);
                size_t wrong = 0;
                for (size_t i = 0; i < rays.size(); ++i)
                    wrong += (closest[i].prim >= 0) != (unit[i].prim >= 0) || (any[i].t == 0) != (unit[i].prim >= 0) ||
                             (unit[i].prim >= 0 &&
                              !(std::fabs(std::ldexp(closest[i].t, -power) - unit[i].t) <= 1e-6f * std::fabs(unit[i].t)));
                EXPECT_EQ(wrong, 0u) << accel << ", " << lanes << " lanes, a scene of 2^" << power;
            }
        }
}

// Directions that are zero, NaN or infinite, or too short: every answer must come in time, and they hit nothing. Rays in the
// same packet must get the same answers as without them.
TEST(Rays, ZeroNanAndInfiniteDirectionsDoNotDisturbOtherRays) {
    const float denormal = 1e-40f;
    const std::vector<rt_ray> strange = {
        ray_of({0, 0, 5}, {0, 0, 0}),
        ray_of({0, 0, 5}, {kNan, 0, -1}),
        ray_of({0, 0, 5}, {kNan, kNan, kNan}),
        ray_of({kNan, 0, 5}, {0, 0, -1}),
        ray_of({kInf, 0, 5}, {0, 0, -1}),
        ray_of({0, 0, 5}, {kInf, 0, -1}),
        ray_of({0, 0, 5}, {0, -kInf, kInf}),
        ray_of({0, 0, 5}, {1e30f, -1e30f, 1e30f}),
        ray_of({0, 0, 5}, {denormal, -denormal, -1}),
        ray_of({0, 0, 5}, {denormal, denormal, denormal}),
        ray_of({0, 0, 5}, {-0.f, 0, -0.f}),
        ray_of({0, 0, 5}, {0, 0, -kInf}),
        ray_of({0, 0, 5}, {0, kNan, -1}),
        ray_of({0, 0, 5}, {0, 0, -8e-19f}),
        ray_of({0, 0, 5}, {8e-19f, -8e-19f, 1e-25f}),
        ray_of({1e30f, 1e30f, -1e30f}, {-1, -1, 1}),
        ray_of({0, 0, 5}, {0, 0, -1}, kNan, kInf),
        ray_of({0, 0, 5}, {0, 0, -1}, 0, kNan),
        ray_of({0, 0, 5}, {0, 0, -1}, 10, 1),
        ray_of({0, 0, 5}, {0, 0, -1}, 0, -1),
    };
    const std::vector<rt_ray> sane = random_rays(shapes()->bounds(), 16 * strange.size(), 7);
    std::vector<rt_ray> mixed;
    for (size_t i = 0; i < sane.size(); ++i) mixed.push_back(i % 5 == 2 ? strange[i / 5 % strange.size()] : sane[i]);
    const int triangles = static_cast<int>(shapes()->triangle_count());
    for (const std::string& accel : bench().accels())
        for (const int lanes : lane_counts(accel))
            for (const bool any : {false, true}) {
                const std::string what = accel + ", " + std::to_string(lanes) + " lanes" + (any ? ", any" : ", closest");
                const std::vector<rt_hit> alone = bench().rays(shapes(), settings_of(accel, lanes), sane, any),
                                          together = bench().rays(shapes(), settings_of(accel, lanes), mixed, any);
                for (size_t i = 0; i < sane.size(); ++i) {
                    if (i % 5 == 2) {
                        const size_t number = i / 5 % strange.size();
                        EXPECT_FALSE(std::isnan(together[i].t)) << what << ", strange ray " << number;
                        EXPECT_GE(together[i].prim, -1) << what;
                        EXPECT_LT(together[i].prim, triangles) << what;
                        if (is_direction(strange[number].direction)) continue;
                        EXPECT_EQ(together[i].t, kInf) << what << ", strange ray " << number;
                        EXPECT_EQ(together[i].prim, -1) << what << ", strange ray " << number;
                    } else {
                        EXPECT_EQ(together[i].t, alone[i].t) << what << ", ray " << i << " beside strange ones";
                    }
                }
            }
    // A direction that is nearly along an axis gives the same hit as the axis itself.
    for (const std::string& accel : bench().accels()) {
        const Settings settings = settings_of(accel, lane_counts(accel).front());
        const rt_hit straight = bench().rays(shapes(), settings, {ray_of({0.1f, 0.2f, 5}, {0, 0, -1})}, false)[0],
                     nearly = bench().rays(shapes(), settings, {ray_of({0.1f, 0.2f, 5}, {denormal, -denormal, -1})}, false)[0];
        EXPECT_FLOAT_EQ(straight.t, nearly.t) << accel;
        EXPECT_TRUE(std::isfinite(straight.t)) << accel;
    }
}

TEST(Rays, NoRayAndOneRay) {
    for (const std::string& accel : bench().accels()) {
        EXPECT_TRUE(bench().rays(shapes(), settings_of(accel, 16), {}, false).empty());
        const std::vector<rt_ray> seventeen(17, ray_of({0.1f, 0.2f, 5}, {0, 0, -1}));
        const std::vector<rt_hit> one = bench().rays(shapes(), settings_of(accel, 16), {seventeen[0]}, false),
                                  many = bench().rays(shapes(), settings_of(accel, 16), seventeen, false);
        ASSERT_EQ(one.size(), 1u);
        ASSERT_EQ(many.size(), 17u);
        EXPECT_TRUE(std::isfinite(one[0].t)) << accel;
        EXPECT_EQ(many[0].t, one[0].t) << accel;
        EXPECT_EQ(many[16].t, one[0].t) << accel;
    }
}

TEST(Rays, AnEmptySceneHasNoHits) {
    const ScenePtr empty = shared_scene(scene_of(TriangleMesh()));
    for (const std::string& accel : bench().accels())
        for (const bool any : {false, true})
            for (const rt_hit& hit :
                 bench().rays(empty, settings_of(accel, 16), random_rays(shapes()->bounds(), 100, 8), any)) {
                EXPECT_EQ(hit.t, kInf) << accel;
                EXPECT_EQ(hit.prim, -1) << accel;
            }
}

}  // namespace
