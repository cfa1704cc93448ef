// Rays against shapes are compared with the reference in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.hpp"
#include "import/import.hpp"
#include "reference.hpp"
#include "support/scratch.hpp"
#include "support/workbench.hpp"

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
    for (const auto& [accel, lanes] : {std::pair("bvh2", "8"), std::pair("linear", "1")}) {
        if (few_ways() && lanes == std::string("1")) continue;
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
}

INSTANTIATE_TEST_SUITE_P(Rays, Shapes, testing::Bool(),
                         [](const auto& info) { return info.param ? "BehindTheFirstHit" : "FromTheirOrigin"; });

// // Statements of shapes in text scenes: what they become, and what is said about wrong ones.

Scene import_text(const Scratch& scratch, const std::string& text, bool in_process = false) {
    import::ImportOptions options;
    options.in_process = in_process;
    Progress progress;
    return import::import_scene(Workbench::get().plugins(), {scratch.write("a.scene", text)}, options, progress);
}

// The message without the folder.
std::string error_of(const std::string& text) {
    const Scratch scratch;
    try {
        import_text(scratch, text);
    } catch (const Error& e) {
        const std::string why = e.what(), path = scratch.path("");
        return why.compare(0, path.size(), path) == 0 ? why.substr(path.size()) : why;
    }
    return "no error";
}

class Places : public ::testing::TestWithParam<bool> {};

TEST_P(Places, AStatementBecomesAShape) {
    const Scratch scratch;
    const Scene scene = import_text(scratch,
                                    "material red color 1 0 0\n"
                                    "cylinder material red radius .5 to 0 3 0 from 0 1 0\n"
                                    "box from 1 1 1 to 0 2 3\n"
                                    "cylinder from 0 0 0 to 1 0 0 radius 2 caps 0\n",
                                    GetParam());
    ASSERT_EQ(scene.shapes.size(), 3u);
    ASSERT_EQ(scene.shape_kinds.size(), 2u);
    EXPECT_EQ(scene.shape_kinds[scene.shapes[0].kind].id, "cylinder");
    EXPECT_EQ(scene.shape_kinds[scene.shapes[0].kind].plugin, Workbench::get().plugins().primitive("cylinder"));
    EXPECT_EQ(scene.shapes[0].material, 1u);
    EXPECT_EQ(scene.shapes[1].material, 0u);
    const ShapePart& first = scene.shape_parts[scene.shapes[0].first_part];
    EXPECT_EQ(first.numbers[1], 1);
    EXPECT_EQ(first.numbers[4], 1);
    EXPECT_EQ(first.numbers[6], 2);
    EXPECT_EQ(first.numbers[8], 1) << "caps by default";
    EXPECT_EQ(first.min[0], -0.5f);
    EXPECT_EQ(first.max[1], 3);
    const ShapePart& box = scene.shape_parts[scene.shapes[1].first_part];
    EXPECT_EQ(box.numbers[0], 1) << "a shape without `prepare` gets its values";
    EXPECT_EQ(box.numbers[5], 3);
    EXPECT_EQ(box.min[0], 0);
    const Bounds bounds = scene.bounds();
    EXPECT_EQ(bounds.max[2], 3);
    EXPECT_EQ(place_of_prim(scene, 1).kind, PrimPlace::Kind::shape);
    EXPECT_EQ(place_of_prim(scene, 1).index, 1u);
}
INSTANTIATE_TEST_SUITE_P(All, Places, testing::Bool(), [](const auto& info) { return info.param ? "InProcess" : "InWorker"; });

TEST(ShapeStatements, PlacedFilesShareTheirParts) {
    const Scratch scratch;
    scratch.write("part.scene",
                  "nurbs points 0 0 0  1 0 0  2 0 1  3 0 0  0 1 0  1 1 2  2 1 0  3 1 0  0 2 0  1 2 0  2 2 0  3 2 0  "
                  "0 3 0  1 3 0  2 3 -1  3 3 0\n");
    const Scene scene = import_text(scratch,
                                    "material red color 1 0 0\nload \"part.scene\"\n"
                                    "load \"part.scene\" translate 5 0 0 material red\n");
    ASSERT_EQ(scene.shapes.size(), 2u);
    EXPECT_EQ(scene.shapes[0].first_part, scene.shapes[1].first_part);
    EXPECT_GT(scene.shapes[0].part_count, 1u);
    EXPECT_EQ(scene.shape_parts.size(), scene.shapes[0].part_count);
    EXPECT_EQ(scene.shapes[1].world_from_object[3], 5);
    EXPECT_EQ(scene.shapes[1].material, 1u);
}

TEST(ShapeStatements, OfALoadedFileThatMovesStayAtRest) {
    const Scratch scratch;
    scratch.write("part.scene", "sphere\nbox from 1 1 1 to 0 2 3\n");
    const std::string load = "load \"part.scene\" name part\n";
    EXPECT_TRUE(import_text(scratch, load).warnings.empty());
    const Scene scene = import_text(scratch, load + "animate part translate 0 0 0 0  1 5 0 0\n");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("2 of its objects stay where they are at rest"), std::string::npos) << scene.warnings[0];
}

TEST(ShapeStatements, ErrorsNameThePlace) {
    EXPECT_EQ(error_of("\n cylindre from 0 0 0"),
              "a.scene:2:2: unknown statement `cylindre`; did you mean `cylinder`? (statements: camera, light, background, "
              "ambient, material, sphere, plane, polygon, triangle, load, animate, edit, sky, texture, box, cone, cylinder, "
              "disc, nurbs, "
              "torus)");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0 radus .5"),
              "a.scene:1:30: unknown key `radus`; did you mean `radius`? (keys of cylinder: from, to, radius, caps, material)");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0"),
              "a.scene:1:1: cylinder without `radius`; expected distance of the side from the axis");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0 radius -1"),
              "a.scene:1:37: `-1` is out of range; expected `radius` (distance of the side from the axis) of 1e-12 at least");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0 radius 1 caps .5"),
              "a.scene:1:44: expected a whole number for `caps` (1: with discs at both ends, 0: open)");
    EXPECT_EQ(
        error_of("disc normal 0 0 0"),
        "a.scene:1:13: the zero vector has no direction; expected another for `normal` (x y z of the direction that it faces)");
    EXPECT_EQ(error_of("box from 0 0 to 1 1 1"),
              "a.scene:1:14: `to` is no number; expected number 3 of 3 for `from` (x y z of a corner)");
    EXPECT_EQ(error_of("box from 0 0 0 to 1 1 1 material red"),
              "a.scene:1:34: unknown material `red` (defined in this file: none)");
    EXPECT_EQ(error_of("nurbs points 0 0 0 1 1"),
              "a.scene:1:23: 5 numbers for `points` (x y z of all points, row after row along u); expected 3 for each point");
}

// What only the shape's plugin knows.
TEST(ShapeStatements, PluginsRefuseValues) {
    EXPECT_EQ(error_of("plane normal 0 1 0\ncylinder from 1 1 1 to 1 1 1 radius 1"),
              "a.scene:2:1: cylinder: `from` and `to` are the same point; expected the two ends of its axis");
    EXPECT_EQ(error_of("torus radius 1 tube 2"),
              "a.scene:1:1: torus: `tube` is not below `radius`; expected a ring with a hole");
    EXPECT_EQ(error_of("nurbs points 0 0 0 1 0 0 0 1 0"), "a.scene:1:1: nurbs: 3 `points` are no full rows of `columns` 4");
    EXPECT_EQ(error_of("nurbs columns 2 degree_u 1 degree_v 1 points 0 0 0 1 0 0 0 1 0 1 1 0 knots_u 0 1 0 1"),
              "a.scene:1:1: nurbs: `knots_u` do not ascend; expected each knot at least as large as the one before");
    EXPECT_EQ(error_of("nurbs columns 2 degree_u 1 degree_v 1 points 0 0 0 1 0 0 0 1 0 1 1 0 weights 1 1 0 1"),
              "a.scene:1:1: nurbs: weight 3 is not above 0");
}

}  // namespace
