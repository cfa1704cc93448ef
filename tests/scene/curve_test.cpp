// curve_test.cpp -- keyed values, rotations and transforms of nodes, against values computed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/motion/clip_values.hpp"
#include "scene/motion/node_transform.hpp"

namespace clarity {
namespace {

struct Keyed {
    Motion motion;
    Channel channel;
    Keyed(std::vector<double> times, std::vector<double> values, std::vector<uint8_t> spans, rt_u32 before = RT_OUTSIDE_HOLD,
          rt_u32 after = RT_OUTSIDE_HOLD) {
        channel.key_count = times.size();
        channel.component = values.size() > times.size() ? rt_u32(RT_ALL_COMPONENTS) : 0;
        channel.before = before;
        channel.after = after;
        motion.key_times = std::move(times);
        motion.key_values = std::move(values);
        motion.key_spans = std::move(spans);
    }
    double at(double time_s) const { return value_at(motion, channel, time_s); }
};

TEST(Curve, SpansOfEachKind) {
    const Keyed keyed({0, 1, 2, 3}, {10, 20, 40, 80}, {RT_SPAN_LINEAR, RT_SPAN_STEP, RT_SPAN_STEP_NEXT, 0});
    EXPECT_EQ(keyed.at(0.25), 12.5);
    EXPECT_EQ(keyed.at(1), 20);
    EXPECT_EQ(keyed.at(1.999), 20);
    EXPECT_EQ(keyed.at(2), 40);
    EXPECT_EQ(keyed.at(2.001), 80);
    EXPECT_EQ(keyed.at(-5), 10);
    EXPECT_EQ(keyed.at(99), 80);
}

// With handles of a third of the span the curve is a Hermite cubic: flat tangents give 3x^2 - 2x^3.
TEST(Curve, HandlesOfAThirdAreHermite) {
    Keyed keyed({0, 3}, {0, 1}, {RT_SPAN_CUBIC, 0});
    keyed.channel.has_handles = 1;
    keyed.motion.key_handles = {0, 0, 1, 0, 1, 0, 0, 0};
    for (const double x : {0.1, 0.5, 0.9}) EXPECT_NEAR(keyed.at(3 * x), 3 * x * x - 2 * x * x * x, 1e-12);
}

// Weighted handles: the point at parameter 1/2 of a Bezier curve with handles of 0.9 and 0.2 seconds is known.
TEST(Curve, WeightedHandlesBendTime) {
    Keyed keyed({0, 1}, {0, 8}, {RT_SPAN_CUBIC, 0});
    keyed.channel.has_handles = 1;
    keyed.motion.key_handles = {0, 0, 0.9, 2, 0.2, 0, 0, 0};
    const double time = (3 * 0.9 + 3 * 0.8 + 1) / 8, value = (3 * 2 + 3 * 8 + 8) / 8.0;
    EXPECT_NEAR(keyed.at(time), value, 1e-9);
}

TEST(Curve, ExtrapolatesEachWay) {
    const std::vector<double> times = {1, 2}, values = {0, 10};
    const auto at = [&](rt_u32 how, double time_s) { return Keyed(times, values, {RT_SPAN_LINEAR, 0}, how, how).at(time_s); };
    EXPECT_NEAR(at(RT_OUTSIDE_REPEAT, 2.25), 2.5, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_REPEAT, 0.75), 7.5, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_MIRROR, 2.25), 7.5, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_MIRROR, 3.25), 2.5, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_MIRROR, 0.75), 2.5, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_SLOPE, 2.5), 15, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_SLOPE, 0.5), -5, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_REPEAT_RELATIVE, 3.5), 25, 1e-12);
    EXPECT_NEAR(at(RT_OUTSIDE_REPEAT_RELATIVE, 0.5), -5, 1e-12);
    Keyed twice(times, values, {RT_SPAN_LINEAR, 0}, RT_OUTSIDE_HOLD, RT_OUTSIDE_REPEAT);
    twice.channel.after_count = 2;
    EXPECT_NEAR(twice.at(3.5), 5, 1e-12);
    EXPECT_NEAR(twice.at(7.5), 10, 1e-12) << "after two repetitions the last value holds";
}

TEST(Curve, QuaternionsTakeTheShorterArc) {
    const double half = std::sqrt(0.5);
    const Keyed keyed({0, 1}, {0, 0, 0, 1, 0, 0, -half, -half}, {RT_SPAN_LINEAR, 0});
    const Quaternion q = quaternion_at(keyed.motion, keyed.channel, 0.5);
    EXPECT_NEAR(std::abs(q[2]), std::sin(3.14159265358979 / 8), 1e-9);
    EXPECT_NEAR(std::abs(q[3]), std::cos(3.14159265358979 / 8), 1e-9);
}

TEST(Angles, EveryOrderComesBack) {
    for (rt_u32 order = RT_ROTATE_XYZ; order <= RT_ROTATE_ZYX; ++order) {
        const Vec angles = {20, -35, 50};
        const Vec back = to_angles(from_angles(angles, order), order);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], angles[i], 1e-9) << "order " << order;
    }
    // Where the middle angle is a right angle, the angles differ but the rotation is the same.
    for (rt_u32 order = RT_ROTATE_XYZ; order <= RT_ROTATE_ZYX; ++order) {
        const Quaternion q = from_angles({90, 90, 90}, order), back = from_angles(to_angles(q, order), order);
        double cosine = 0;
        for (int i = 0; i < 4; ++i) cosine += q[i] * back[i];
        EXPECT_NEAR(std::abs(cosine), 1, 1e-9) << "order " << order;
    }
}

// About x first, then y: the y axis goes to z, which then goes to x.
TEST(Angles, XyzTurnsAboutXFirst) {
    const Vec moved = direction(rotation(from_angles({90, 90, 0}, RT_ROTATE_XYZ)), {0, 1, 0});
    EXPECT_NEAR(moved[0], 1, 1e-12);
    const Vec other = direction(rotation(from_angles({90, 90, 0}, RT_ROTATE_YXZ)), {0, 1, 0});
    EXPECT_NEAR(other[2], 1, 1e-12);
}

rt_node_desc node_of(rt_u32 inherit, Vec degrees, Vec scale) {
    rt_node_desc node{};
    node.inherit = inherit;
    for (int i = 0; i < 3; ++i) {
        node.rotation[i] = degrees[i];
        node.scale[i] = scale[i];
    }
    for (auto* matrix : {&node.before_rotation, &node.after_rotation, &node.after_scale})
        std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), *matrix);
    return node;
}

TEST(Nodes, InheritScaleInEachWay) {
    const rt_node_desc parent = node_of(RT_INHERIT_RSRS, {0, 0, 0}, {2, 1, 1});
    const PlacedNode placed = place_node(parent, values_at_rest(parent), nullptr);
    const auto x_axis = [&](rt_u32 inherit) {
        const rt_node_desc child = node_of(inherit, {0, 0, 90}, {1, 3, 1});
        return direction(place_node(child, values_at_rest(child), &placed).world, {1, 0, 0});
    };
    // The child's x axis points along the parent's y, which is not scaled.
    EXPECT_NEAR(length(x_axis(RT_INHERIT_RSRS)), 1, 1e-12);
    EXPECT_NEAR(x_axis(RT_INHERIT_RRSS)[1], 2, 1e-12) << "the parent's scale of x acts along the child's x";
    EXPECT_NEAR(x_axis(RT_INHERIT_RRS)[1], 1, 1e-12);
}

// A chain of nodes with several ways, whose scales do not commute with the rotations. S: the scale of the node at the top,
// which Rrs at the end leaves in, because it is not that of the parent itself.
TEST(Nodes, InheritScaleThroughChains) {
    const auto matrix_of = [](const std::vector<rt_node_desc>& chain) {
        PlacedNode placed;
        for (size_t i = 0; i < chain.size(); ++i)
            placed = place_node(chain[i], values_at_rest(chain[i]), i ? &placed : nullptr);
        return placed.world;
    };
    const Vec turn_a{20, 50, -30}, turn_b{-70, 10, 40}, turn_c{15, 25, 80};
    const Matrix a = rotation(from_angles(turn_a, RT_ROTATE_XYZ)), b = rotation(from_angles(turn_b, RT_ROTATE_XYZ)),
                 c = rotation(from_angles(turn_c, RT_ROTATE_XYZ));
    const Matrix sa = scaling({3, 1, 0.5}), sb = scaling({1, 4, 2}), sc = scaling({0.5, 1, 2});
    const auto expect = [&](rt_u32 way_b, rt_u32 way_c, const Matrix& wanted) {
        const Matrix found = matrix_of({node_of(RT_INHERIT_RSRS, turn_a, {3, 1, 0.5}), node_of(way_b, turn_b, {1, 4, 2}),
                                        node_of(way_c, turn_c, {0.5, 1, 2})});
        for (size_t i = 0; i < 12; ++i) EXPECT_NEAR(found[i], wanted[i], 1e-12) << "ways " << way_b << " " << way_c;
    };
    expect(RT_INHERIT_RSRS, RT_INHERIT_RSRS, a * sa * b * sb * c * sc);
    expect(RT_INHERIT_RSRS, RT_INHERIT_RRSS, a * sa * b * c * sb * sc);
    expect(RT_INHERIT_RSRS, RT_INHERIT_RRS, a * sa * b * c * sc);
    expect(RT_INHERIT_RRSS, RT_INHERIT_RSRS, a * b * sa * sb * c * sc);
    expect(RT_INHERIT_RRSS, RT_INHERIT_RRSS, a * b * c * sa * sb * sc);
    expect(RT_INHERIT_RRSS, RT_INHERIT_RRS, a * b * c * sa * sc);
    expect(RT_INHERIT_RRS, RT_INHERIT_RSRS, a * b * sb * c * sc);
    expect(RT_INHERIT_RRS, RT_INHERIT_RRSS, a * b * c * sb * sc);
    expect(RT_INHERIT_RRS, RT_INHERIT_RRS, a * b * c * sc);
}

TEST(Nodes, TransformsApplyInOrder) {
    rt_node_desc node = node_of(RT_INHERIT_RSRS, {0, 0, 90}, {2, 2, 2});
    node.translation[0] = 10;
    node.before_rotation[3] = 1;  // a pivot at x = 1
    node.after_rotation[3] = -1;
    const Vec moved = point(place_node(node, values_at_rest(node), nullptr).world, {1, 0, 0});
    // Scaled to 2, less the pivot 1, turned to y = 1, plus the pivot, plus the translation.
    EXPECT_NEAR(moved[0], 11, 1e-12);
    EXPECT_NEAR(moved[1], 1, 1e-12);
}

}  // namespace
}  // namespace clarity
