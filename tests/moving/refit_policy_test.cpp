// refit_policy_test.cpp -- the policy beside fixed strategies, on motions with known costs.
#include "moving/follow/refit_policy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

using namespace clarity;

namespace {

constexpr int kFrames = 200;
constexpr double kTraceMs = 10, kRefitMs = 1;

// A motion: how much slower than a fresh tree a tree of pose `built` is in pose `now`; 1: as fast.
using Ratio = std::function<double(int built, int now)>;

double total_ms(const Ratio& ratio, double build_ms, const std::function<bool(int frame)>& builds) {
    double ms = 0;
    int built = 0;
    for (int frame = 1; frame <= kFrames; ++frame) {
        const bool build = builds(frame);
        if (build) built = frame;
        ms += (build ? build_ms : kRefitMs) + kTraceMs * ratio(built, frame);
    }
    return ms;
}

double of_the_policy(const Ratio& ratio, double build_ms) {
    RefitPolicy policy;
    policy.built(build_ms - kRefitMs);
    double ms = 0;
    int built = 0;
    for (int frame = 1; frame <= kFrames; ++frame) {
        const bool build = policy.wants_build();
        if (build) built = frame;
        const double r = ratio(built, frame), trace = kTraceMs * r;
        ms += (build ? build_ms : kRefitMs) + trace;
        if (build)
            policy.built(build_ms - kRefitMs);
        else
            policy.refitted(r, trace);
    }
    return ms;
}

// Always refit, always build, every k frames: the best in hindsight.
double of_the_best(const Ratio& ratio, double build_ms) {
    double best = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= kFrames + 1; ++k)
        best = std::min(best, total_ms(ratio, build_ms, [&](int frame) { return frame % k == 0; }));
    return best;
}

void expect_near_the_best(const char* what, const Ratio& ratio, double most = 1.10) {
    for (const double build_ms : {2.0, 5.0, 20.0, 50.0, 200.0, 1000.0}) {
        const double best = of_the_best(ratio, build_ms), ours = of_the_policy(ratio, build_ms);
        EXPECT_LE(ours, most * best) << what << ", builds of " << build_ms << " ms: " << ours / best << " times the best";
    }
}

TEST(RefitPolicy, DecayingTrees) {
    for (const double slope : {0.001, 0.01, 0.05})
        expect_near_the_best("linear decay", [&](int built, int now) { return 1 + slope * (now - built); });
    expect_near_the_best("an explosion",
                         [](int built, int now) { return std::min(8.0, 1 + 0.002 * std::pow(now - built, 2)); });
}

TEST(RefitPolicy, MotionsThatReturn) {
    for (const double period : {25.0, 60.0, 160.0})
        for (const double size : {0.1, 0.5})
            expect_near_the_best("back and forth", [&](int built, int now) {
                const auto at = [&](int frame) { return std::sin(2 * 3.14159265 * frame / period); };
                return 1 + size * std::fabs(at(now) - at(built));
            });
}

// A wheel that turns: half a turn away from the tree's pose it is slowest, wherever that pose is. At worst 1.108.
TEST(RefitPolicy, MotionsThatTurn) {
    for (const double period : {25.0, 60.0, 160.0})
        for (const double size : {0.1, 0.5})
            expect_near_the_best(
                "a turn",
                [&](int built, int now) { return 1 + size * std::fabs(std::sin(3.14159265 * (now - built) / period)); }, 1.11);
}

TEST(RefitPolicy, OneChangeForGood) {
    for (const double size : {0.05, 0.5, 3.0})
        expect_near_the_best("a step", [&](int built, int now) { return built < 40 && now >= 40 ? 1 + size : 1.0; });
}

TEST(RefitPolicy, StillScenesAndTreesThatImproveAreNeverBuilt) {
    RefitPolicy policy;
    policy.built(0.5);
    for (int i = 0; i < 1000; ++i) {
        policy.refitted(i % 2 ? 1 : 0.8, 10);
        ASSERT_FALSE(policy.wants_build());
    }
}

TEST(RefitPolicy, NothingIsKnownBeforeTheFirstBuild) {
    RefitPolicy policy;
    EXPECT_FALSE(policy.wants_build());
}

}  // namespace
