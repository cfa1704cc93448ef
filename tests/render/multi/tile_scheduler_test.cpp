// tile_scheduler_test.cpp -- who gets what of a picture, played through with devices of given speeds.
#include "render/multi/tile_scheduler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

using namespace clarity;

namespace {

struct Played {
    std::vector<unsigned> tiles;  // of each device
    std::vector<double> ends;     // when it is done
    double last() const { return *std::max_element(ends.begin(), ends.end()); }
};

// ms a strip of each device. Every strip must be dealt, and only once.
Played play(TileScheduler& dealer, unsigned count, const std::vector<double>& ms, bool alike) {
    dealer.begin(count, std::vector<bool>(ms.size(), true), alike);
    Played played{std::vector<unsigned>(ms.size()), std::vector<double>(ms.size(), 0.0)};
    std::vector<unsigned> dealt(count);
    std::vector<bool> done(ms.size());
    while (std::find(done.begin(), done.end(), false) != done.end()) {
        size_t next = ms.size();  // who is free first
        for (size_t i = 0; i < ms.size(); ++i)
            if (!done[i] && (next == ms.size() || played.ends[i] < played.ends[next])) next = i;
        const std::vector<unsigned> tiles = dealer.next(next);
        done[next] = tiles.empty();
        for (const unsigned tile : tiles) ++dealt.at(tile);
        played.tiles[next] += unsigned(tiles.size());
        played.ends[next] += ms[next] * double(tiles.size());
        dealer.took(next, tiles.size(), ms[next] * double(tiles.size()));
    }
    EXPECT_EQ(std::count(dealt.begin(), dealt.end(), 1u), long(count));
    return played;
}

}  // namespace

TEST(TileScheduler, DealsEachStripOnce) {
    for (const unsigned count : {1u, 2u, 3u, 7u, 68u, 135u, 2048u})
        for (const auto& ms : std::vector<std::vector<double>>{{1}, {1, 1}, {1, 3, 9}, {1, 1, 1, 1, 1, 1, 1, 1}, {100, 1}})
            for (const bool alike : {true, false}) {
                TileScheduler dealer(ms.size());
                for (int picture = 0; picture < 4; ++picture) play(dealer, count, ms, alike);
            }
}

TEST(TileScheduler, DevicesOfOneKindEndTogether) {
    TileScheduler dealer(2);
    for (int picture = 0; picture < 3; ++picture) {
        const Played played = play(dealer, 135, {1, 1}, true);
        EXPECT_LE(std::abs(int(played.tiles[0]) - int(played.tiles[1])), 1) << picture;
    }
}

TEST(TileScheduler, SpeedsAreLearnt) {
    TileScheduler dealer(2);
    const std::vector<double> ms = {1, 4};
    Played played;
    for (int picture = 0; picture < 6; ++picture) {
        played = play(dealer, 100, ms, false);
        // From the first picture on, by turns: at the worst, one waits for a strip of the slow one.
        EXPECT_LE(played.last(), 80 + 4 + 1e-9) << picture;
    }
    EXPECT_NEAR(played.tiles[0], 80, 2);
    EXPECT_NEAR(dealer.share(0), 0.8, 0.02);
}

TEST(TileScheduler, ASlowDeviceDoesNotHoldUpThePicture) {
    TileScheduler dealer(2);
    for (int picture = 0; picture < 4; ++picture) EXPECT_LE(play(dealer, 64, {1, 200}, false).last(), 200 + 1e-9) << picture;
    // Once it is known, it has nothing at all.
    EXPECT_LE(play(dealer, 64, {1, 200}, false).last(), 200);
}

TEST(TileScheduler, WhoTakesNoPartGetsNothing) {
    TileScheduler dealer(3);
    dealer.begin(10, {true, false, true}, true);
    EXPECT_TRUE(dealer.next(1).empty());
    EXPECT_EQ(dealer.share(1), 0);
    size_t dealt = 0;
    for (const size_t device : {0, 2})
        for (auto tiles = dealer.next(device); !tiles.empty(); tiles = dealer.next(device)) dealt += tiles.size();
    EXPECT_EQ(dealt, 10u);
}

// Neighbours in the picture cost alike, so everybody needs some of every part of it.
TEST(TileScheduler, SharesAreSpreadOverThePicture) {
    TileScheduler dealer(2);
    dealer.begin(100, {true, true}, true);
    for (const size_t device : {0, 1}) {
        const std::vector<unsigned> tiles = dealer.next(device);
        ASSERT_GT(tiles.size(), 30u);
        for (size_t i = 1; i < tiles.size(); ++i) EXPECT_LE(tiles[i] - tiles[i - 1], 4u);
    }
}
