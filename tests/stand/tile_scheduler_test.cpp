// tile_scheduler_test.cpp -- simulates devices of given speeds, and checks which tiles they get, and whether they share at all.
#include "stand/tile_scheduler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

using namespace clarity;

namespace {

std::vector<unsigned> numbers(unsigned count) {
    std::vector<unsigned> all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

struct Played {
    std::vector<unsigned> tiles;  // number of tiles of each device
    std::vector<double> ends;     // time at which each device is done, ms
    double last() const { return *std::max_element(ends.begin(), ends.end()); }
};

// Simulates a picture. ms: time of a tile on each device. Every tile must be assigned exactly once.
Played play(TileScheduler& scheduler, unsigned count, const std::vector<double>& ms, bool alike) {
    scheduler.begin(numbers(count), std::vector<bool>(ms.size(), true), alike);
    Played played{std::vector<unsigned>(ms.size()), std::vector<double>(ms.size(), 0.0)};
    std::vector<unsigned> assigned(count);
    std::vector<bool> done(ms.size());
    while (std::find(done.begin(), done.end(), false) != done.end()) {
        size_t next = ms.size();  // the device that is free first
        for (size_t i = 0; i < ms.size(); ++i)
            if (!done[i] && (next == ms.size() || played.ends[i] < played.ends[next])) next = i;
        const std::vector<unsigned> tiles = scheduler.next(next);
        done[next] = tiles.empty();
        for (const unsigned tile : tiles) ++assigned.at(tile);
        played.tiles[next] += unsigned(tiles.size());
        played.ends[next] += ms[next] * double(tiles.size());
        scheduler.took(next, tiles.size(), ms[next] * double(tiles.size()));
    }
    EXPECT_EQ(std::count(assigned.begin(), assigned.end(), 1u), long(count));
    return played;
}

}  // namespace

TEST(TileScheduler, AssignsEachTileOnce) {
    for (const unsigned count : {1u, 2u, 3u, 7u, 68u, 135u, 2048u})
        for (const auto& ms : std::vector<std::vector<double>>{{1}, {1, 1}, {1, 3, 9}, {1, 1, 1, 1, 1, 1, 1, 1}, {100, 1}})
            for (const bool alike : {true, false}) {
                TileScheduler scheduler(ms.size());
                for (int picture = 0; picture < 4; ++picture) play(scheduler, count, ms, alike);
            }
}

TEST(TileScheduler, DevicesOfOneKindGetEqualShares) {
    TileScheduler scheduler(2);
    for (int picture = 0; picture < 3; ++picture) {
        const Played played = play(scheduler, 135, {1, 1}, true);
        EXPECT_LE(std::abs(int(played.tiles[0]) - int(played.tiles[1])), 1) << picture;
    }
}

TEST(TileScheduler, ADeviceThatWasBusyGetsTilesAgain) {
    TileScheduler scheduler(2);
    for (int picture = 0; picture < 8; ++picture) play(scheduler, 2048, {1, 200}, true);
    Played played;
    for (int picture = 0; picture < 8; ++picture) {
        played = play(scheduler, 8, {1, 1}, true);
        EXPECT_GE(played.tiles[1], 1u) << picture;
    }
    EXPECT_EQ(played.tiles[1], 4u);
}

TEST(TileScheduler, SharesFollowMeasuredSpeeds) {
    TileScheduler scheduler(2);
    const std::vector<double> ms = {1, 4};
    Played played;
    for (int picture = 0; picture < 6; ++picture) {
        played = play(scheduler, 100, ms, false);
        // Tiles are assigned dynamically from the first picture on. At worst, one device waits for a tile of the slow one.
        EXPECT_LE(played.last(), 80 + 4 + 1e-9) << picture;
    }
    EXPECT_NEAR(played.tiles[0], 80, 2);
    EXPECT_NEAR(scheduler.share(0), 0.8, 0.02);
}

TEST(TileScheduler, ASlowDeviceDoesNotDelayThePicture) {
    TileScheduler scheduler(2);
    for (int picture = 0; picture < 4; ++picture) EXPECT_LE(play(scheduler, 64, {1, 200}, false).last(), 200 + 1e-9) << picture;
    // Once its speed is known, it gets no tile at all.
    EXPECT_LE(play(scheduler, 64, {1, 200}, false).last(), 200);
}

TEST(TileScheduler, AnExcludedDeviceGetsNoTile) {
    TileScheduler scheduler(3);
    scheduler.begin(numbers(10), {true, false, true}, true);
    EXPECT_TRUE(scheduler.next(1).empty());
    EXPECT_EQ(scheduler.share(1), 0);
    size_t assigned = 0;
    for (const size_t device : {0, 2})
        for (auto tiles = scheduler.next(device); !tiles.empty(); tiles = scheduler.next(device)) assigned += tiles.size();
    EXPECT_EQ(assigned, 10u);
}

// Neighbouring tiles cost about the same, so each device needs tiles from all parts of the picture.
TEST(TileScheduler, TilesOfADeviceAreSpreadOverThePicture) {
    TileScheduler scheduler(2);
    scheduler.begin(numbers(100), {true, true}, true);
    for (const size_t device : {0, 1}) {
        const std::vector<unsigned> tiles = scheduler.next(device);
        ASSERT_GT(tiles.size(), 30u);
        for (size_t i = 1; i < tiles.size(); ++i) EXPECT_LE(tiles[i] - tiles[i - 1], 4u);
    }
}

namespace {

// Mean time of `count` pictures, ms. together, alone: time of a picture by all devices, and by the fastest; share: of the
// latter.
double mean_ms(TeamChoice& choice, unsigned count, double together, double alone, double share) {
    double sum = 0;
    for (unsigned i = 0; i < count; ++i) {
        const double ms = choice.alone() ? alone : together;
        sum += ms;
        choice.took(ms, share);
    }
    return sum / count;
}

}  // namespace

// Of 1000 pictures, trials included.
TEST(TeamChoice, CostsLittleMoreThanTheFasterWay) {
    struct Case {
        double together, alone, share;
    };
    // Measured: a bunny at 4K by an H100 and 16 cores. Then a slow device that spoils short pictures, and one that pays.
    for (const Case& c : {Case{15.6, 15.4, 0.93}, Case{0.6, 0.5, 0.6}, Case{0.9, 0.5, 0.99}, Case{90, 100, 0.9}}) {
        TeamChoice choice;
        const double best = std::min(c.together, c.alone);
        const double mean = mean_ms(choice, 1000, c.together, c.alone, c.share);
        EXPECT_LT(mean, 1.01 * best) << c.together << " " << c.alone;
        EXPECT_GT(mean, best) << "the other way is tried";
        EXPECT_EQ(choice.alone(), c.alone < c.together);
    }
}

TEST(TeamChoice, DevicesWhoseGainIsClearAreNeverTriedAlone) {
    TeamChoice choice;
    EXPECT_DOUBLE_EQ(mean_ms(choice, 400, 55, 100, 0.5), 55);
}

TEST(TeamChoice, FollowsSpeedsThatChange) {
    TeamChoice choice;
    mean_ms(choice, 50, 15.6, 15.4, 0.93);
    EXPECT_TRUE(choice.alone());
    mean_ms(choice, 50, 100, 110, 0.9);
    EXPECT_FALSE(choice.alone());
}
