// pace_test.cpp -- pieces of a picture stay short on any device. The device is simulated, with a given speed.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "launch/launch.hpp"

using clarity::Pace;

namespace {

constexpr double kLaunchMs = 0.02, kLimitMs = 500;

struct Picture {
    double longest_ms = 0;
    unsigned pieces = 0;
};

// group_ms: the time of a group, by its number.
Picture trace(Pace& pace, unsigned groups, const std::function<double(unsigned)>& group_ms, double compile_ms = 0,
              unsigned most = ~0u) {
    Picture picture;
    pace.begin_picture();
    for (unsigned first = 0; first < groups;) {
        const unsigned count = pace.next(groups - first, most);
        EXPECT_GE(count, 1u);
        EXPECT_LE(count, std::min(groups - first, most));
        double ms = kLaunchMs;
        for (unsigned i = first; i < first + count; ++i) ms += group_ms(i);
        picture.longest_ms = std::max(picture.longest_ms, ms);
        pace.took(count, ms + (first == 0 ? compile_ms : 0));
        first += count;
        ++picture.pieces;
        if (count == 0) break;
    }
    pace.end_picture();
    return picture;
}

TEST(Pace, PiecesTakeLessThanHalfASecondOnAnyDevice) {
    // From 40 ms a group (64 pixels, 64 lights and depth 16 at 1.6 Mrays/s) to the speed of a large GPU.
    for (const double ms : {40.0, 8.0, 1.0, 0.1, 0.01, 1e-3, 1e-5})
        for (const unsigned groups : {1u, 192u, 12288u, 129600u}) {
            if (ms * groups > 1e6) continue;
            Pace pace;
            for (int picture = 0; picture < 3; ++picture) {
                const Picture p = trace(pace, groups, [=](unsigned) { return ms; });
                EXPECT_LE(p.longest_ms, kLimitMs) << ms << " ms a group, " << groups << " groups, picture " << picture;
                if (picture > 0) {
                    EXPECT_LE(p.pieces, 2 + ms * groups / 100) << ms << " ms a group: cut too fine";
                }
            }
        }
}

TEST(Pace, FastPicturesAreOnePieceFromTheSecondOn) {
    Pace pace;
    trace(pace, 12288, [](unsigned) { return 4e-5; });
    for (int picture = 1; picture < 4; ++picture) EXPECT_EQ(trace(pace, 12288, [](unsigned) { return 4e-5; }).pieces, 1u);
}

// Sky, then a model that takes ten times as long, then sky again. The next picture's pace must not follow the last sky.
TEST(Pace, PiecesOfUnevenPicturesStayShort) {
    const auto uneven = [](unsigned group) { return group > 4000 && group < 9000 ? 0.5 : 0.05; };
    Pace pace;
    for (int picture = 0; picture < 4; ++picture) EXPECT_LE(trace(pace, 12288, uneven).longest_ms, kLimitMs) << picture;
    const auto steep = [](unsigned group) { return group > 4000 && group < 9000 ? 2.0 : 0.02; };
    pace.forget();
    trace(pace, 12288, steep);
    for (int picture = 1; picture < 4; ++picture) EXPECT_LE(trace(pace, 12288, steep).longest_ms, kLimitMs) << picture;
}

TEST(Pace, IgnoresTheTimeOfACompilation) {
    Pace pace;
    trace(pace, 12288, [](unsigned) { return 1e-4; }, 3000);
    EXPECT_EQ(trace(pace, 12288, [](unsigned) { return 1e-4; }).pieces, 1u);
}

TEST(Pace, ExpectsTheTimeOfThePreviousPicture) {
    Pace pace;
    EXPECT_TRUE(std::isinf(pace.expected_ms(1)));
    for (int picture = 0; picture < 2; ++picture) trace(pace, 12288, [](unsigned) { return 1e-3; });
    EXPECT_NEAR(pace.expected_ms(12288), 12.3, 0.1);
    pace.forget();
    EXPECT_TRUE(std::isinf(pace.expected_ms(1)));
}

TEST(Pace, PiecesAreNotLargerThanTheLimit) {
    Pace pace;
    for (int picture = 0; picture < 2; ++picture)
        EXPECT_GE(trace(pace, 1000, [](unsigned) { return 1e-4; }, 0, 300).pieces, 4u);
}

}  // namespace
