// Rays against shapes are compared with the reference in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A ray that aims at a placed shape from near, from within or from far away; some run along an axis.
rt_ray ray_at(const PlacedShape& placed, std::mt19937& random, size_t number) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> within(-1, 1);
    const double reach = placed.shape->reach, away = number % 8 == 0 ? 300 : number % 8 == 1 ? 0.4 * reach : 3 * reach;
    const auto around = [&](double radius) {
        Vec v = {normal(random), normal(random), normal(random)};
        const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (double& x : v) x *= radius / length;
        return v;
    };
    const Vec from = transformed(placed.world, around(away)),
              to = transformed(placed.world, around(0.8 * reach * std::fabs(within(random))));
    rt_ray ray{};
    ray.t_max = INFINITY;
    double direction[3], length2 = 0;
    for (size_t k = 0; k < 3; ++k) {
        direction[k] = to[k] - from[k];
        if (number % 8 == 2 && k != number / 8 % 3) direction[k] = 0;
        length2 += direction[k] * direction[k];
    }
    for (size_t k = 0; k < 3; ++k) {
        ray.direction[k] = static_cast<float>(direction[k] / std::sqrt(length2));
        ray.origin[k] = static_cast<float>(number % 8 == 2 ? to[k] - 4 * direction[k] / std::sqrt(length2) : from[k]);
    }
    return ray;
}

struct Truth {
    double t;
    bool certain;  // not at a silhouette, nor nearly along the surface: there, rounding decides
};
Truth truth_of(const rt_ray& ray) {
    constexpr double kBeside = 2e-4;
    const Vec o = {ray.origin[0], ray.origin[1], ray.origin[2]}, d = {ray.direction[0], ray.direction[1], ray.direction[2]};
    Truth truth{nearest_hit(o, d, ray.t_min), true};
    for (size_t k = 0; k < 3; ++k)
        for (const double side : {-kBeside, kBeside}) {
            Vec beside = o;
            beside[k] += side;
            const double t = nearest_hit(beside, d, ray.t_min);
            if (t != truth.t && !(std::fabs(t - truth.t) < 1e-2)) truth.certain = false;
        }
    return truth;
}

struct Cases {
    std::vector<rt_ray> rays;
    std::vector<Truth> truths;
    std::vector<std::string> names;  // of the shapes that the rays aim at
};
// Rays at all shapes. `again`: those that start behind the first hit.
const Cases& cases(bool again) {
    static const auto make = [](bool behind) {
        Cases all;
        std::mt19937 random(5);
        for (const PlacedShape& placed : placed_shapes())
            for (size_t i = 0; i < 240; ++i) {
                rt_ray ray = ray_at(placed, random, i);
                if (behind) {
                    const Truth first = truth_of(ray);
                    if (!std::isfinite(first.t)) continue;
                    ray.t_min = static_cast<float>(first.t * 1.001);
                }
                all.rays.push_back(ray);
                all.truths.push_back(truth_of(ray));
                all.names.push_back(placed.shape->name);
            }
        return all;
    };
    static const Cases first = make(false), second = make(true);
    return again ? second : first;
}

std::vector<rt_hit> trace(const std::string& accel, const std::string& lanes, const std::vector<rt_ray>& rays,
                          bool any_hit = false) {
    return Workbench::get().rays(imported_shapes(), make_settings({{"accel", accel}, {"lanes", lanes}}), rays, any_hit);
}

class Shapes : public ::testing::TestWithParam<bool> {};

TEST_P(Shapes, AreHitWhereTheReferenceSays) {
    const Cases& all = cases(GetParam());
    const std::vector<rt_hit> hits = trace("bvh2", "8", all.rays);
    size_t certain = 0, hit = 0;
    double worst = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
        if (!all.truths[i].certain) continue;
        ++certain;
        const double expected = all.truths[i].t;
        hit += std::isfinite(expected);
        // The ray's own numbers are rounded: a distance near 0 is as exact as the coordinates of its origin.
        const rt_ray& ray = all.rays[i];
        const double origin =
            std::fmax(std::fmax(std::fabs(ray.origin[0]), std::fabs(ray.origin[1])), std::fabs(ray.origin[2]));
        const bool agrees = std::isfinite(expected) ? std::fabs(hits[i].t - expected) <= 1e-4 * expected + 1.2e-7 * origin
                                                    : !std::isfinite(hits[i].t);
        if (std::isfinite(expected) && agrees) worst = std::fmax(worst, std::fabs(hits[i].t - expected) / expected);
        const rt_ray& r = all.rays[i];
        EXPECT_TRUE(agrees) << all.names[i] << ", ray " << i << ": expected " << expected << ", found " << hits[i].t
                            << ", from " << r.origin[0] << ' ' << r.origin[1] << ' ' << r.origin[2] << " along "
                            << r.direction[0] << ' ' << r.direction[1] << ' ' << r.direction[2] << " t_min " << r.t_min;
    }
    RecordProperty("worst_relative_error", std::to_string(worst));
    std::printf("%zu rays, %zu certain, %zu hits, largest relative error %.2g\n", hits.size(), certain, hit, worst);
    EXPECT_GT(certain, hits.size() * 9 / 10);
    EXPECT_GT(hit, hits.size() / 4);
}

TEST_P(Shapes, AreTheSameForAnyLanesAndStructure) {
    const Cases& all = cases(GetParam());
    const std::vector<rt_hit> expected = trace("bvh2", "8", all.rays);
    for (const auto& [accel, lanes] : {std::pair("linear", "8"), std::pair("bvh2", "1"), std::pair("linear", "1")}) {
        SCOPED_TRACE(std::string(accel) + ", lanes " + lanes);
        const std::vector<rt_hit> found = trace(accel, lanes, all.rays);
        size_t differing = 0;
        for (size_t i = 0; i < found.size(); ++i) differing += found[i].t != expected[i].t || found[i].prim != expected[i].prim;
        EXPECT_EQ(differing, 0u);
    }
}

TEST_P(Shapes, OccludeUpToTheirDistance) {
    const Cases& all = cases(GetParam());
    for (const auto& [accel, lanes] : {std::pair("bvh2", "8"), std::pair("linear", "1")})
        for (const float share : {0.999f, 1.001f}) {
            SCOPED_TRACE(std::string(accel) + ", lanes " + lanes + ", t_max " + std::to_string(share) + " of the distance");
            std::vector<rt_ray> rays;
            for (size_t i = 0; i < all.rays.size(); ++i) {
                if (!all.truths[i].certain || all.truths[i].t * 0.999 <= all.rays[i].t_min) continue;
                rays.push_back(all.rays[i]);
                rays.back().t_max = std::isfinite(all.truths[i].t) ? static_cast<float>(all.truths[i].t) * share : INFINITY;
            }
            const std::vector<rt_hit> found = trace(accel, lanes, rays, true), nearest = trace(accel, lanes, rays);
            size_t wrong = 0, wrong_nearest = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                const bool expected = share > 1 && std::isfinite(rays[i].t_max);
                wrong += (found[i].t == 0) != expected;
                wrong_nearest += std::isfinite(nearest[i].t) != expected;
            }
            EXPECT_EQ(wrong, 0u);
            EXPECT_EQ(wrong_nearest, 0u);
        }
}

INSTANTIATE_TEST_SUITE_P(Rays, Shapes, testing::Bool(),
                         [](const auto& info) { return info.param ? "BehindTheFirstHit" : "FromTheirOrigin"; });

}  // namespace
