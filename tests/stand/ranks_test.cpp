// ranks_test.cpp -- a picture that several processes share equals that of one, bit for bit. Here the processes are threads,
// each with a device of its own.
#include "stand/ranks.hpp"

#include <algorithm>

#include "stand/team.hpp"
#include "stand/thread_ranks.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

TEST(DealTiles, FollowsSpeeds) {
    const std::vector<unsigned> rank_of = deal_tiles(100, {1, 3});
    EXPECT_EQ(std::count(rank_of.begin(), rank_of.end(), 0u), 25);
    EXPECT_EQ(std::count(rank_of.begin(), rank_of.begin() + 20, 0u), 5) << "from all parts of the picture";
    const std::vector<unsigned> even = deal_tiles(7, {0, 0, 0});
    for (unsigned r = 0; r < 3; ++r) EXPECT_GE(std::count(even.begin(), even.end(), r), 2) << "unknown speeds are equal";
    EXPECT_TRUE(deal_tiles(0, {1}).empty());
}

TEST(CollectRows, RefusesRowsOfAnotherPicture) {
    on_ranks(2, [](Ranks& ranks) {
        std::vector<char> picture(4 * 10, static_cast<char>('a' + ranks.rank()));
        collect_rows(ranks, {{ranks.rank() * 2, 2}}, 10, 4, picture.data());
        if (ranks.rank() == 0) {
            EXPECT_EQ(std::string(picture.begin(), picture.end()), std::string(20, 'a') + std::string(20, 'b'));
            EXPECT_THROW(collect_rows(ranks, {}, 10, 4, picture.data()), Error);
        } else {
            picture.resize(200);
            collect_rows(ranks, {{3, 2}}, 10, 20, picture.data());
        }
    });
}

struct RankPicture {
    FloatPixels values;
    std::string display;
};

class RankPictures : public ::testing::TestWithParam<unsigned> {
 protected:
    // What rank 0 has at the end.
    static RankPicture trace(unsigned count, const Settings& settings, unsigned pictures = 1) {
        const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
        const View view = make_view(*scene, float(settings.width) / float(settings.height));
        RankPicture whole;
        const auto one = [&](Ranks* ranks) {
            const Devices devices = open_devices(choose_devices("cpu"));
            MultiPreparer preparer(Workbench::get().plugins(), devices);
            MultiFrameRenderer frames(devices, ranks);
            Progress progress;
            const auto prepared = preparer.prepare(scene, settings, progress);
            for (unsigned i = 0; i < pictures; ++i) {
                for (int sample = 0; sample < settings.spp; sample += 2)
                    frames.trace(prepared, settings, view, unsigned(sample), true, progress,
                                 unsigned(std::min(2, settings.spp - sample)));
                const FloatImage values = frames.read_values();
                const ByteImage display = frames.read_display(settings);
                if (ranks && ranks->rank() > 0) continue;
                whole.values = values.pixels;
                whole.display.assign(reinterpret_cast<const char*>(display.pixels.data()), display.pixels.size());
            }
        };
        if (count == 1)
            one(nullptr);
        else
            on_ranks(count, [&](Ranks& ranks) { one(&ranks); });
        return whole;
    }
    static void expect_same(const Settings& settings, unsigned pictures = 1) {
        const RankPicture alone = trace(1, settings), shared = trace(GetParam(), settings, pictures);
        EXPECT_EQ(differing(alone.values, shared.values), 0u);
        EXPECT_TRUE(alone.display == shared.display);
    }
};

TEST_P(RankPictures, EqualThoseOfOneProcess) {
    expect_same(make_settings({{"accel", "bvh2"}, {"size", "97x61"}, {"spp", "3"}}));
}

// With many samples tiles are dealt by measured speed, anew for each picture.
TEST_P(RankPictures, AreDealtBySpeed) {
    expect_same(make_settings({{"accel", "bvh2"}, {"size", "64x300"}, {"spp", "40"}}), 3);
}

TEST_P(RankPictures, HaveFewerRowsThanRanks) {
    expect_same(make_settings({{"accel", "bvh2"}, {"size", "40x1"}, {"spp", "12"}}));
}

INSTANTIATE_TEST_SUITE_P(, RankPictures, ::testing::Values(2u, 3u));

}  // namespace
