// A face gives n - 2 triangles. Convex faces become fans, the triangles of concave ones cover exactly their area, and no face
// takes very long.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "base/angle.hpp"
#include "scene/triangulate.hpp"
#include "support/clock.hpp"

namespace clarity {
namespace {

using Points = std::vector<std::array<double, 2>>;

// Puts the face on a slanted plane, so that the projection is tested too. Lengths stay the same.
std::vector<float> on_a_slope(const Points& points) {
    const double u[3] = {0.6, 0, 0.8}, v[3] = {0.8 * 0.28, 0.96, -0.6 * 0.28};
    std::vector<float> positions;
    for (const auto& p : points) {
        for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(7 + p[0] * u[k] + p[1] * v[k]));
    }
    return positions;
}

std::vector<rt_u32> triangles_of(const Points& points, Triangulator& triangulator) {
    const std::vector<float> positions = on_a_slope(points);
    std::vector<rt_u32> corners(points.size()), out;
    for (rt_u32 i = 0; i < corners.size(); ++i) corners[i] = i;
    triangulator.add(positions.data(), corners.data(), static_cast<rt_u32>(corners.size()), out);
    return out;
}
std::vector<rt_u32> triangles_of(const Points& points) {
    Triangulator triangulator;
    return triangles_of(points, triangulator);
}

double signed_area(const Points& p, const rt_u32* t) {
    return 0.5 *
           ((p[t[1]][0] - p[t[0]][0]) * (p[t[2]][1] - p[t[0]][1]) - (p[t[1]][1] - p[t[0]][1]) * (p[t[2]][0] - p[t[0]][0]));
}
double polygon_area(const Points& p) {
    double sum = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        const auto &a = p[i], &b = p[(i + 1) % p.size()];
        sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    return sum;
}

// The sums of signed and of absolute areas must both equal the polygon's area: then there is no overlap, no gap and no flipped
// triangle.
void expect_exact_cover(const Points& points) {
    const std::vector<rt_u32> triangles = triangles_of(points);
    ASSERT_EQ(triangles.size(), 3 * (points.size() - 2));
    double with_sign = 0, without = 0;
    for (size_t i = 0; i < triangles.size(); i += 3) {
        const double area = signed_area(points, &triangles[i]);
        with_sign += area;
        without += std::abs(area);
    }
    const double expected = polygon_area(points);
    EXPECT_NEAR(with_sign, expected, 1e-6 * std::abs(expected));
    EXPECT_NEAR(without, std::abs(expected), 1e-5 * std::abs(expected));
}

Points circle(int n, double inner) {
    Points points;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * kPi * i / n, r = i % 2 != 0 ? 1 : inner;
        points.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    return points;
}

TEST(Triangulate, convex_faces_are_fans_from_the_first_corner) {
    EXPECT_EQ(triangles_of({{0, 0}, {2, 0}, {2, 1}, {0, 1}}), (std::vector<rt_u32>{0, 1, 2, 0, 2, 3}));
    for (const int n : {5, 32, 1000}) {
        const std::vector<rt_u32> triangles = triangles_of(circle(n, 1));
        ASSERT_EQ(triangles.size(), 3u * (n - 2));
        for (rt_u32 i = 0; i + 2 < static_cast<rt_u32>(n); ++i) {
            EXPECT_EQ(triangles[3 * i], 0u);
            EXPECT_EQ(triangles[3 * i + 1], i + 1);
            EXPECT_EQ(triangles[3 * i + 2], i + 2);
        }
    }
}

TEST(Triangulate, clockwise_faces_keep_their_orientation) {
    EXPECT_EQ(triangles_of({{0, 0}, {0, 1}, {2, 1}, {2, 0}}), (std::vector<rt_u32>{0, 1, 2, 0, 2, 3}));
    Points arrow = {{0, 0}, {2, 1}, {0, 2}, {1, 1}};
    expect_exact_cover(arrow);
    std::reverse(arrow.begin(), arrow.end());
    expect_exact_cover(arrow);
}

TEST(Triangulate, concave_faces_are_covered_exactly) {
    expect_exact_cover({{1, 1}, {0, 0}, {2, 1}, {0, 2}});
    expect_exact_cover({{0, 0}, {4, 0}, {4, 3}, {3, 3}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});
    for (const double inner : {0.1, 0.5, 0.9}) expect_exact_cover(circle(60, inner));
    // Corners in the middle of straight edges.
    expect_exact_cover({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 1}, {0, 2}, {0, 1}});
    // A hole, which is joined to the outline by a slit; the corners of the slit occur twice.
    expect_exact_cover({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
}

TEST(Triangulate, random_stars_are_covered_exactly) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> radius(0.05, 1), step(0.2, 1);
    for (int run = 0; run < 200; ++run) {
        std::vector<double> angles;
        double sum = 0;
        const int n = 4 + run % 40;
        for (int i = 0; i < n; ++i) angles.push_back(sum += step(random));
        Points points;
        for (const double angle : angles) {
            const double r = radius(random), a = 2 * kPi * angle / sum;
            points.push_back({r * std::cos(a), r * std::sin(a)});
        }
        expect_exact_cover(points);
    }
}

TEST(Triangulate, anything_gives_n_minus_2_triangles) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    for (int run = 0; run < 300; ++run) {
        Points points(4 + run % 30);
        for (auto& p : points)
            p = {anywhere(random), run % 3 == 0 ? 0 : run % 3 == 1 ? std::round(anywhere(random)) : anywhere(random)};
        const std::vector<rt_u32> triangles = triangles_of(points);
        ASSERT_EQ(triangles.size(), 3 * (points.size() - 2));
        for (const rt_u32 corner : triangles) ASSERT_LT(corner, points.size());
    }
    EXPECT_EQ(triangles_of(Points(8, {1, 1})).size(), 18u) << "all corners in one point";
    EXPECT_TRUE(triangles_of(Points(2, {1, 1})).empty());
}

// The corners of a unit square. One diagonal is longer by `stretch`, and every other corner is lifted off the plane.
std::vector<rt_u32> bent_quad(double stretch, float lift) {
    const float s = static_cast<float>(stretch);
    const float positions[12] = {0, 0, lift, 1, 0, -lift, 1 + s, 1 + s, lift, 0, 1, -lift};
    const rt_u32 corners[4] = {0, 1, 2, 3};
    std::vector<rt_u32> out;
    Triangulator().add(positions, corners, 4, out);
    return out;
}

TEST(Triangulate, bent_quads_are_cut_along_the_shorter_diagonal) {
    EXPECT_EQ(bent_quad(0.2, 0.1f), (std::vector<rt_u32>{0, 1, 3, 1, 2, 3}));
    EXPECT_EQ(bent_quad(-0.2, 0.1f), (std::vector<rt_u32>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(bent_quad(0.2, 0), (std::vector<rt_u32>{0, 1, 2, 0, 2, 3})) << "a flat one stays a fan";
}

TEST(Triangulate, far_from_the_origin_a_square_is_still_a_fan) {
    std::vector<float> positions;
    for (const float p : {0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f, 1.f}) positions.push_back(p);
    std::vector<float> corners3;
    for (int i = 0; i < 4; ++i) {
        for (const float p : {20000 + 0.01f * positions[2 * i], 20000 + 0.01f * positions[2 * i + 1], 30000.f})
            corners3.push_back(p);
    }
    const rt_u32 corners[4] = {0, 1, 2, 3};
    std::vector<rt_u32> out;
    Triangulator().add(corners3.data(), corners, 4, out);
    EXPECT_EQ(out, (std::vector<rt_u32>{0, 1, 2, 0, 2, 3}));
}

// Fewer in builds whose every access is checked, and more time: the tangle is given up after as many steps.
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
constexpr int kHuge = 100000;
constexpr double kMostSeconds = 60;
#else
constexpr int kHuge = 3000;
constexpr double kMostSeconds = 300;
#endif
TEST(Triangulate, huge_faces_take_seconds_at_most) {
    const auto start = std::chrono::steady_clock::now();
    Points comb, tangle;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    for (int i = 0; i < kHuge; ++i) {
        comb.push_back({double(i), i % 2 != 0 ? 1. : 100.});
        tangle.push_back({anywhere(random), anywhere(random)});
    }
    comb.push_back({double(kHuge), -5});
    comb.push_back({0, -5});
    expect_exact_cover(comb);
    expect_exact_cover(circle(kHuge, 0.5));
    Triangulator triangulator;
    EXPECT_EQ(triangles_of(tangle, triangulator).size(), 3 * (tangle.size() - 2));
    EXPECT_EQ(triangulator.given_up(), 1u) << "and it says so";
    const Points arrow = {{0, 0}, {2, 1}, {0, 2}, {1, 1}, {0.5, 0.9}};
    EXPECT_EQ(triangles_of(arrow, triangulator), triangles_of(arrow)) << "later faces do not pay for it";
    EXPECT_EQ(triangulator.given_up(), 1u);
    EXPECT_LT(test::seconds_since(start), test::at_most(kMostSeconds));
}

}  // namespace
}  // namespace clarity
