// replay_test.cpp -- the samples of a pixel that are traced once more are those of the film bit for bit, and their paths' light
// adds up to them.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "images/path_checks.hpp"
#include "support/planted_faults.hpp"
#include "support/scenes.hpp"
#include "tracers/replay/replay.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

PathReplayer& replayer() {
    static auto* const one = new PathReplayer(Workbench::get().shared_device());  // never destroyed, like the workbench
    return *one;
}

struct Recorded {
    ScenePtr scene;
    View view;
    Settings settings;
    std::shared_ptr<const Prepared> prepared;
    FloatImage picture;

    Recorded(const char* file, const Pairs& more, float aperture = 0) : scene(load_scene(source_file(file))) {
        Pairs all = {{"tracer", "path"}, {"size", "31x23"}, {"depth", "6"}, {"accel", "bvh2"}, {"spp", "21"}};
        all.insert(all.end(), more.begin(), more.end());
        settings = make_settings(all);
        view = make_view(*scene, 31.0f / 23);
        view.camera.aperture = aperture;
        Progress progress;
        prepared = Workbench::get().prepare(scene, settings, view);
        FrameRenderer& frames = Workbench::get().frames();
        frames.trace(*prepared, settings, view, Samples(0, unsigned(settings.spp)), false, progress);
        picture = frames.read_values();
    }
    // In several calls, as motion blur traces them.
    Replay replay(unsigned x, unsigned y, std::vector<unsigned> calls = {21}) const {
        Replay all;
        Progress progress;
        for (const unsigned count : calls) replayer().trace(*prepared, settings, view, x, y, count, progress, all);
        return all;
    }
    std::array<float, 3> pixel(unsigned x, unsigned y) const {
        const float* const p = &picture.pixels[3 * (size_t(y) * picture.width + x)];
        return {p[0], p[1], p[2]};
    }
};

// The light of the records of each sample is the sample's, but for rounding, and paths are whole.
void expect_records_add_up(const Replay& replay, unsigned depth) {
    for (const ReplayedSample& sample : replay.samples) {
        ASSERT_GE(sample.records, 1u);
        const rt_path_record* const records = &replay.records[sample.first_record];
        ASSERT_EQ(records[0].kind, RT_PATH_BEGINS);
        double sum[3] = {};
        unsigned events = 0;
        for (unsigned r = 1; r < sample.records; ++r) {
            const rt_path_record& record = records[r];
            ASSERT_NE(record.kind, RT_PATH_BEGINS);
            for (int k = 0; k < 3; ++k) sum[k] += record.light[k];
            if (record.kind == RT_PATH_SCATTERS) {
                EXPECT_EQ(record.bounce, ++events);
                EXPECT_LE(events, depth);
            } else {
                EXPECT_EQ(record.bounce, events + (record.how == RT_BY_NEE ? 1 : 0));
                EXPECT_TRUE(record.mis > 0 && record.mis <= 1) << record.mis;
            }
        }
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], sample.light[k], 2e-5 * std::fabs(sample.light[k]) + 1e-7);
    }
}

void expect_the_film(const Recorded& traced, const std::string& what) {
    size_t lit = 0;
    for (unsigned y = 1; y < 23; y += 3)
        for (unsigned x = 0; x < 31; x += 3) {
            const Replay replay = traced.replay(x, y);
            ASSERT_EQ(replay.samples.size(), 21u);
            ASSERT_EQ(replay.mean, traced.pixel(x, y)) << what << ", pixel " << x << "," << y;
            expect_records_add_up(replay, unsigned(traced.settings.depth));
            if (::testing::Test::HasFailure()) return;
            lit += replay.mean[1] > 0;
        }
    EXPECT_GT(lit, 40u) << what << ": too little light to prove anything";
}

constexpr const char* kScene = "scenes/showpiece.scene";

TEST(PathReplay, IsTheFilmBitForBitWithALens) {
    expect_the_film(Recorded(kScene, {{"lanes", "8"}, {"filter", "gaussian"}, {"seed", "7"}, {"mis", "balance"}}, 0.3f),
                    "lens");
}

TEST(PathReplay, IsTheFilmBitForBitForSamplersAndStrategies) {
    for (const char* sampler : {"independent", "sobol"})
        for (const char* strategy : {"nee", "bsdf", "mis"})
            expect_the_film(Recorded(kScene, {{"lanes", "8"}, {"sampler", sampler}, {"strategy", strategy}}),
                            std::string(sampler) + ", " + strategy);
    expect_the_film(Recorded(kScene, {{"lanes", "8"}, {"only_bounce", "2"}, {"only_by", "bsdf"}}), "parts of the light");
}

TEST(PathReplay, IsTheFilmBitForBitForLanesAndPackets) {
    for (const int lanes : lane_counts())
        for (const char* packet : {"8x8", "7x3"})
            expect_the_film(Recorded(kScene, {{"lanes", std::to_string(lanes)}, {"packet", packet}}),
                            std::to_string(lanes) + " lanes, packets " + packet);
}

TEST(PathReplay, OfSeveralScenesAndStructures) {
    for (const char* file : {"scenes/primitives.scene", "scenes/shapes.scene"})
        for (const char* accel : {"bvh4", "bvh8"}) expect_the_film(Recorded(file, {{"accel", accel}}), file);
}

TEST(PathReplay, InSeveralCallsIsTheSame) {
    const Recorded traced(kScene, {{"lanes", "8"}});
    const Replay one = traced.replay(15, 15), several = traced.replay(15, 15, {1, 1, 9, 10});
    EXPECT_EQ(several.mean, one.mean);
    ASSERT_EQ(several.samples.size(), one.samples.size());
    for (size_t s = 0; s < one.samples.size(); ++s) EXPECT_EQ(several.samples[s].light, one.samples[s].light) << s;
    ASSERT_EQ(several.records.size(), one.records.size());
    const Replay other = Recorded(kScene, {{"lanes", "8"}, {"seed", "1"}}).replay(15, 15);
    EXPECT_NE(other.mean, one.mean) << "seeds change nothing";
}

TEST(PathReplay, RefusesAPixelOutside) {
    const Recorded traced(kScene, {{"lanes", "8"}});
    EXPECT_THROW(traced.replay(31, 0), Error);
    EXPECT_THROW(traced.replay(0, 23), Error);
}

const PlantedFault kReplayFaults[] = {
    {"TheNextSample", "tracers/replay/replay.cl", "first) - 1)", "first))", "PathReplay.*WithALens"},
    {"APixelBeside", "tracers/replay/replay.cl", "(uint2)(x, y)", "(uint2)(x + 1u, y)", "PathReplay.*WithALens"},
    {"OneLevelOfSums", "tracers/replay/replay.cl", "rt_add_sample(film, 1, 0, lights[s], adds == 0u && s == 0u)",
     "film[0] = (adds == 0u && s == 0u ? (float4)(0.0f) : film[0]) + lights[s]", "PathReplay.*WithALens"},
    {"NoLightDrawn", "tracers/path/scatter.h", "RT_RECORD(rt_record_light(", "RT_RECORD(if (by != RT_BY_NEE) rt_record_light(",
     "PathReplay.*WithALens"},
    {"LightBeforeTheWeight", "tracers/path/scatter.h", "lanes, p->weight, light, bounce, by, first, number)",
     "lanes, p->weight, p->weight, bounce, by, first, number)", "PathReplay.*WithALens"},
};

TEST(ReplayTexts, HaveTheirTexts) {
    expect_plantable(kReplayFaults);
}

class ReplayFaults : public testing::TestWithParam<PlantedFault> {};

TEST_P(ReplayFaults, AreFound) {
    EXPECT_EQ(why_not_found(GetParam()), "");
}
INSTANTIATE_TEST_SUITE_P(Planted, ReplayFaults, testing::ValuesIn(kReplayFaults),
                         [](const auto& info) { return info.param.name; });

}  // namespace
