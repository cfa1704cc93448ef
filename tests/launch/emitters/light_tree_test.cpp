// light_tree_test.cpp -- the light tree: its bounds hold all emitters, and its probabilities are those of its draws.
#include "launch/emitters/light_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "launch/emitters/light_bench.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// Many lights in a box of 20 x 4 x 20, which shine into all directions or to the side of a normal.
std::vector<rt_light> many_lights(unsigned count, bool sided, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> number(-1, 1);
    std::vector<rt_light> lights;
    for (unsigned i = 0; i < count; ++i) {
        const Point at = {10 * number(generator), 2 + 2 * number(generator), 10 * number(generator)};
        const Point normal = {number(generator), number(generator) - 0.5f, number(generator)};
        const float power = std::exp(2 * number(generator));
        switch (sided ? i % 4 : i % 2) {
            case 0:
                lights.push_back(sphere_light(at, 0.05f, 100 * power));
                break;
            case 1:
                lights.push_back(point_light(at, power));
                break;
            case 2:
                lights.push_back(disc_light(at, normal, 0.1f, 50 * power));
                lights.back().flags |= i % 8 < 4 ? RT_LIGHT_TWO_SIDED : 0;
                break;
            default:
                lights.push_back(spot_light(at, normal, 3 * power, 20, 50));
        }
    }
    return lights;
}

View lit_by_many(unsigned count, bool sided) {
    View view = dark_view();
    view.lights = many_lights(count, sided, 7);
    return view;
}

Point random_point(std::mt19937& generator) {
    std::uniform_real_distribution<float> number(-1, 1);
    return {11 * number(generator), 2 + 3 * number(generator), 11 * number(generator)};
}

TEST(LightTree, BoundsHoldTheirEmitters) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<LightBound> bounds(300);
    for (size_t i = 0; i < bounds.size(); ++i) {
        LightBound& b = bounds[i];
        const Vec corner = {number(generator), number(generator), i % 7 == 0 ? 0 : number(generator)};
        b = bound_of_flat(&corner, 1, {number(generator), number(generator), number(generator)});
        b.reach = i % 3 == 0 ? 0.4 : kPi / 2;
        b.two_sided = i % 5 == 0;
        b.intensity = 1 + number(generator);
        b.emitter = rt_u32(i);
    }
    std::vector<rt_u32> leaves;
    const std::vector<rt_light_node> nodes = build_light_tree(bounds, leaves);
    ASSERT_EQ(nodes.size(), 2 * bounds.size() - 1);
    for (size_t i = 0; i < bounds.size(); ++i) {
        const LightBound& b = bounds[i];
        EXPECT_EQ(nodes[leaves[i]].emitter, i);
        for (rt_u32 at = leaves[i]; at != RT_NONE; at = nodes[at].parent) {
            const rt_light_node& node = nodes[at];
            for (size_t k = 0; k < 3; ++k) {
                EXPECT_LE(node.lower[k], b.lower[k] + 1e-6);
                EXPECT_GE(node.upper[k], b.upper[k] - 1e-6);
            }
            double along = dot(to_vec(node.axis), b.axis);
            if (node.two_sided) along = std::fabs(along);
            EXPECT_GE(along, node.cos_spread) << "emitter " << i << ", node " << at;
            EXPECT_LE(node.cos_reach, std::cos(b.reach) + 1e-12);
            EXPECT_TRUE(node.two_sided || !b.two_sided);
            if (node.parent == RT_NONE) continue;
            const rt_u32 first = nodes[node.parent].child;
            EXPECT_TRUE(at == first || at == first + 1);
            EXPECT_NEAR(nodes[first].intensity + nodes[first + 1].intensity, nodes[node.parent].intensity, 1e-6);
        }
    }
}

TEST(LightTree, LightsInOnePlaceAreTakenApart) {
    std::vector<rt_u32> leaves;
    EXPECT_TRUE(build_light_tree({}, leaves).empty());
    LightBound one = bound_of_ball({1, 2, 3}, 0);
    one.intensity = 1;
    EXPECT_EQ(build_light_tree({one}, leaves).size(), 1u);
    EXPECT_EQ(build_light_tree(std::vector<LightBound>(100, one), leaves).size(), 199u);
}

// Everywhere some light is picked, if all shine everywhere.
TEST(LightTree, ChancesAddUpToOne) {
    LightBench bench(empty_scene(), lit_by_many(220, false), 8, true);
    std::mt19937 generator(1);
    for (int i = 0; i < 50; ++i) {
        const Point at = random_point(generator);
        double sum = 0;
        for (const float chance : bench.chances(at, {})) sum += double(chance);
        ASSERT_NEAR(sum, 1, 1e-5) << at[0] << " " << at[1] << " " << at[2];
    }
}

// The largest distance between how often emitters were picked and their chances, in standard errors; and the emitters that
// shine to a point and have no chance.
struct Picks {
    double worst = 0;
    int forgotten = 0;
};
Picks compare_picks(LightBench& bench) {
    Picks picks;
    std::mt19937 generator(2);
    for (int i = 0; i < 8; ++i) {
        const Point at = random_point(generator);
        const Vec normal = normalized(to_vec(random_point(generator)));
        const std::vector<float> chances = bench.chances(at, normal);
        const size_t count = 1 << 16;
        std::vector<double> picked(chances.size(), 0);
        for (const LightDraw& draw : bench.draw(at, random_numbers(count, unsigned(i)), normal)) {
            if (!draw.valid || size_t(draw.number) >= chances.size()) continue;
            ++picked[size_t(draw.number)];
            picks.forgotten += chances[size_t(draw.number)] <= 0;
        }
        for (size_t e = 0; e < chances.size(); ++e) {
            if (picked[e] == 0) continue;  // does not shine there
            const double expected = double(count) * double(chances[e]);
            picks.worst = std::max(picks.worst, std::fabs(picked[e] - expected) / std::sqrt(expected + 1));
        }
    }
    return picks;
}

TEST(LightTree, EmittersArePickedAsTheirChancesSay) {
    LightBench bench(empty_scene(), lit_by_many(220, true), 8, true);
    const Picks picks = compare_picks(bench);
    EXPECT_LT(picks.worst, 5.5);
    EXPECT_EQ(picks.forgotten, 0);
}

// The irradiance by all lights, drawn by the tree and by the table: the largest difference in standard errors, and the standard
// errors of the table by those of the tree.
struct Difference {
    double worst = 0, gain = 0;
};
Difference differ() {
    const View view = lit_by_many(220, true);
    LightBench table(empty_scene(), view), tree(empty_scene(), view, 8, true);
    std::mt19937 generator(4);
    double worst = 0, gain = 0;
    for (int i = 0; i < 12; ++i) {
        const Point at = random_point(generator);
        const Vec normal = normalized(to_vec(random_point(generator)));
        double of_table = 0, of_tree = 0;
        const double a = table.irradiance(at, normal, random_numbers(1 << 16, 1), &of_table),
                     b = tree.irradiance(at, normal, random_numbers(1 << 16, 2), &of_tree);
        worst = std::max(worst, std::fabs(a - b) / std::hypot(of_table, of_tree));
        gain += std::log(of_table / of_tree) / 12;
    }
    return {worst, std::exp(gain)};
}

TEST(LightTree, GivesTheLightOfTheTableWithLessNoise) {
    const Difference found = differ();
    EXPECT_LT(found.worst, 4);
    EXPECT_GT(found.gain, 2);
}

TEST(PlantedFaults, OfTheLightTreeAreFound) {
    const auto picks_with = [](const char* from, const char* to) {
        const FaultyKernel planted("shading/light_tree.h", from, to);
        if (quick()) {  // the text is there
            Picks any;
            any.worst = INFINITY;
            return any;
        }
        LightBench bench(empty_scene(), lit_by_many(220, true), 8, true);
        return compare_picks(bench);
    };
    EXPECT_GT(picks_with("chance *= node == first ? share : 1.0f - share;", "chance *= share;").worst, 8)
        << "the second child's share";
    EXPECT_GT(picks_with("number = min((first ? number : number - share) / mine, 0.99999994f);", "").worst, 8)
        << "the number is not stretched";
    const FaultyKernel planted("shading/light_tree.h", "if (node->two_sided != 0u) cosine = fabs(cosine);", "");
    if (quick()) return;
    EXPECT_GT(differ().worst, 8) << "one side of two is forgotten";
}

}  // namespace
