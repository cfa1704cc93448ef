// cost_test.cpp -- what all structures report as their expected cost (rt_cost.hpp): one measure, told from the volumes that
// they show.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness.hpp"
#include "rt_cost.hpp"
#include "spheres_types.h"

using namespace accel_test;

namespace {

struct Structure {
    const char* id;
    std::map<std::string, double> params;
    bool shows_exact_volumes;  // those of `levels` are those that count
};
const Structure kStructures[] = {{"bvh2", {{"max_leaf", 1}}, true},
                                 {"bvh2", {{"max_leaf", 1}, {"reinsert", 10}}, true},
                                 {"bvh4", {{"max_leaf", 1}}, true},
                                 {"bvh8", {{"max_leaf", 1}}, true},
                                 {"cwbvh", {{"max_leaf", 1}}, false},
                                 {"spheres", {{"max_leaf", 1}, {"volume", SPHERES_BOX}, {"top_level", 1}}, true},
                                 {"spheres", {{"max_leaf", 1}, {"top_level", 1}}, false},
                                 {"kdtree", {}, true},
                                 {"octree", {}, true},
                                 {"bsp", {{"directions", 3}}, true},
                                 {"bsp", {}, false}};

Built built_of(const Structure& structure, const Input& input) {
    return build(load(structure.id), input, {structure.params, 2, {}});
}

double surface(const std::vector<Volume>& volumes) {
    double sum = 0;
    for (const Volume& v : volumes) sum += rt::surface_of(v.lo, v.hi);
    return sum;
}

}  // namespace

TEST(ExpectedCost, IsThatOfTheVolumesThatAreShown) {
    const Input input = one_group(scattered(3000, 10, 0, 3));
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (const rt_prim& prim : input.prims)
        for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], prim.lo[a]), hi[a] = std::max(hi[a], prim.hi[a]);
    const double whole = rt::surface_of(lo, hi);
    for (const Structure& structure : kStructures) {
        if (!structure.shows_exact_volumes) continue;
        SCOPED_TRACE(structure.id);
        const Built built = built_of(structure, input);
        const double leaves = surface(volumes(load(structure.id), built, 0, RT_LEVEL_BOTTOM));
        double all = 0;
        for (rt_u32 level = 0; level <= built.stats.at("depth"); ++level)
            all += surface(volumes(load(structure.id), built, 0, level));
        EXPECT_NEAR(built.stats.at("sah_nodes"), (all - leaves) / whole, 1e-4 * all / whole);
        if (structure.params.count("max_leaf") > 0) {
            EXPECT_NEAR(built.stats.at("sah_primitives"), leaves / whole, 1e-4 * leaves / whole);
        }
    }
}

TEST(ExpectedCost, OfOnePrimitiveIsOneTest) {
    for (const Structure& structure : kStructures) {
        const Built built = built_of(structure, one_group({cube(1, 2, 3, 4, 0)}));
        EXPECT_NEAR(built.stats.at("sah_primitives"), 1, 1e-5) << structure.id;
        EXPECT_LE(built.stats.at("sah_nodes"), 1.001) << structure.id;
    }
}

TEST(ExpectedCost, OfGridsCountsCellsAndTheirPrimitives) {
    // One cell, and 100 boxes in it.
    const Input input = one_group(scattered(100, 10, 0, 3));
    const Built one = build(load("grid"), input, {{{"density", 0.1}}, 2, {}}),
                many = build(load("grid"), input, {{{"density", 64}}, 2, {}});
    EXPECT_GT(many.stats.at("sah_nodes"), 3 * one.stats.at("sah_nodes"));
    EXPECT_LT(many.stats.at("sah_primitives"), 0.5 * one.stats.at("sah_primitives"));
    for (const char* id : {"grid", "grid2"}) {
        const Built built = build(load(id), one_group(scattered(3000, 10, 0, 3)));
        EXPECT_GT(built.stats.at("sah_nodes"), 1) << id;
        EXPECT_LT(built.stats.at("sah_primitives"), 100) << id;
    }
}

TEST(ExpectedCost, WeightedByTheBuildersCostsIsItsOwn) {
    Input input;
    input.add_group(bumpy_sphere(5000));
    input.add_group(scattered(3000, 5, 1, 9));
    number(input);
    for (const char* id : {"bvh2", "bvh4", "bvh8", "cwbvh"}) {
        const Built built = build(load(id), input, {{{"traversal_cost", 2.5}, {"intersection_cost", 0.5}}, 2, {}});
        const double own = built.stats.at("sah_cost");
        EXPECT_NEAR(2.5 * built.stats.at("sah_nodes") + 0.5 * built.stats.at("sah_primitives"), own, 1e-9 * own) << id;
    }
}
