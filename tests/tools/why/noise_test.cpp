// noise_test.cpp -- the shares of a pixel's variance, its histogram and its cause, of paths that are made by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tools/why/noise.hpp"

using namespace clarity;

namespace {

constexpr int kSky = 0x40000001;

rt_path_record event_of(rt_u32 how, rt_u32 bounce, rt_u32 flags = 0, float pdf = 0.2f) {
    rt_path_record record{};
    record.kind = RT_PATH_SCATTERS;
    record.how = how;
    record.bounce = bounce;
    record.flags = flags;
    record.pdf = pdf;
    record.light_number = -1;
    return record;
}

rt_path_record light_of(float gray, rt_u32 by, rt_u32 bounce, int light = 0, float other_pdf = 0,
                        rt_u32 first = RT_FIRST_DIFFUSE) {
    rt_path_record record{};
    record.kind = RT_PATH_LIT;
    for (float& c : record.light) c = gray;
    record.how = by;
    record.bounce = bounce;
    record.light_number = light;
    record.material = -1;
    record.mis = 1;
    record.pdf = 0.2f;
    record.other_pdf = other_pdf;
    record.first = first;
    return record;
}

void add_sample(Replay& replay, const std::vector<rt_path_record>& records) {
    ReplayedSample sample;
    sample.first_record = replay.records.size();
    sample.records = unsigned(records.size());
    for (const rt_path_record& record : records) {
        for (int k = 0; k < 3; ++k) sample.light[k] += record.light[k];
        replay.records.push_back(record);
    }
    replay.samples.push_back(sample);
}

NoiseNames names_of(size_t lights, const char* strategy = "mis") {
    NoiseNames names;
    names.strategy = strategy;
    for (size_t i = 0; i < lights; ++i) names.lights.push_back("lamp" + std::to_string(i));
    return names;
}

double sum_of(const std::vector<NoiseShare>& shares, double NoiseShare::* of) {
    double sum = 0;
    for (const NoiseShare& share : shares) sum += share.*of;
    return sum;
}

double share_of(const std::vector<NoiseShare>& shares, const std::string& name) {
    for (const NoiseShare& share : shares)
        if (share.name == name) return share.of_variance;
    ADD_FAILURE() << "no share of " << name;
    return 0;
}

TEST(Noise, SharesOfEachKindAddUpToOne) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number(0, 1);
    Replay replay;
    for (int s = 0; s < 500; ++s) {
        std::vector<rt_path_record> path;
        const int count = int(number(random) * 6);
        for (int r = 0; r < count; ++r)
            path.push_back(light_of(number(random) * number(random), number(random) < 0.5f ? RT_BY_NEE : RT_BY_BSDF, rt_u32(r),
                                    int(number(random) * 4), 0, r == 0 ? RT_PATH_NO_EVENT : rt_u32(number(random) * 3)));
        add_sample(replay, path);
    }
    const NoiseReport report = noise_report(replay, names_of(4));
    for (const auto* shares : {&report.by_bounce, &report.by_lobe, &report.by_strategy, &report.by_light}) {
        EXPECT_NEAR(sum_of(*shares, &NoiseShare::of_variance), 1, 1e-12);
        EXPECT_NEAR(sum_of(*shares, &NoiseShare::of_light), 1, 1e-12);
        EXPECT_GE(shares->size(), 2u);
    }
    double squares = 0;
    unsigned samples = 0;
    for (const NoiseBin& bin : report.histogram) squares += bin.of_variance, samples += bin.samples;
    EXPECT_NEAR(squares, 1, 1e-12);
    EXPECT_EQ(samples, 500u);
    for (size_t i = 1; i < report.brightest.size(); ++i)
        EXPECT_GE(replay.samples[report.brightest[i - 1]].light[1], replay.samples[report.brightest[i]].light[1]);
    EXPECT_EQ(report.brightest.size(), 10u);
}

// Two independent parts of variances 1 and 9 have a tenth and nine tenths of it; a constant part has none.
TEST(Noise, AShareIsThePartsVarianceIfPartsAreIndependent) {
    Replay replay;
    for (int s = 0; s < 400; ++s)
        add_sample(replay, {light_of(s % 2 ? 2.0f : 0.0f, RT_BY_NEE, 1, 0), light_of(s / 2 % 2 ? 6.0f : 0.0f, RT_BY_BSDF, 2, 1),
                            light_of(5, RT_BY_BSDF, 0, 2)});
    const NoiseReport report = noise_report(replay, names_of(3));
    EXPECT_NEAR(share_of(report.by_light, "lamp `lamp0`"), 0.1, 1e-9);
    EXPECT_NEAR(share_of(report.by_light, "lamp `lamp1`"), 0.9, 1e-9);
    EXPECT_NEAR(share_of(report.by_light, "lamp `lamp2`"), 0, 1e-9);
    EXPECT_NEAR(share_of(report.by_strategy, "drawn (nee)"), 0.1, 1e-9);
    EXPECT_NEAR(share_of(report.by_bounce, "2"), 0.9, 1e-9);
    EXPECT_NEAR(report.variance, 10.0 * 400 / 399, 1e-6);
    EXPECT_EQ(report.by_light.front().name, "lamp `lamp1`") << "the largest share comes first";
}

// A part that is dark where the other is bright takes variance away.
TEST(Noise, AShareMayBeNegative) {
    Replay replay;
    for (int s = 0; s < 100; ++s)
        add_sample(replay, {light_of(s % 2 ? 1.0f : 0.0f, RT_BY_NEE, 1, 0), light_of(s % 2 ? 0.0f : 3.0f, RT_BY_NEE, 1, 1)});
    const NoiseReport report = noise_report(replay, names_of(2));
    EXPECT_NEAR(share_of(report.by_light, "lamp `lamp0`"), -0.5, 1e-9);
    EXPECT_NEAR(share_of(report.by_light, "lamp `lamp1`"), 1.5, 1e-9);
}

// 1000 samples of which the first few are bright by `path`, and the others by nothing.
NoiseReport report_of(const std::vector<rt_path_record>& path, size_t lights = 1, const char* strategy = "mis") {
    Replay replay;
    for (int s = 0; s < 1000; ++s) add_sample(replay, s < 5 ? path : std::vector<rt_path_record>{});
    return noise_report(replay, names_of(lights, strategy));
}

TEST(Noise, CausesAreToldApart) {
    const rt_path_record diffuse = event_of(RT_FIRST_DIFFUSE, 1);
    const auto smooth = [](rt_u32 bounce) { return event_of(RT_FIRST_TRANSMISSION, bounce, RT_PATH_SMOOTH, 0); };
    NoiseReport report = report_of({diffuse, light_of(9, RT_BY_BSDF, 1, 0, 300)}, 1, "bsdf");
    EXPECT_EQ(report.cause, NoiseCause::lamp) << report.sentence;
    EXPECT_NE(report.sentence.find("5 of 1000 samples"), std::string::npos) << report.sentence;
    EXPECT_NE(report.sentence.find("lamp `lamp0`"), std::string::npos) << report.sentence;
    EXPECT_NE(report.sentence.find("--strategy mis"), std::string::npos) << report.sentence;
    EXPECT_EQ(report_of({diffuse, light_of(9, RT_BY_BSDF, 1, 0, 0)}).cause, NoiseCause::lamp) << "it cannot be drawn";
    EXPECT_EQ(report_of({diffuse, smooth(2), smooth(3), light_of(9, RT_BY_BSDF, 3)}).cause, NoiseCause::caustic);
    EXPECT_NE(report_of({smooth(1), smooth(2), light_of(9, RT_BY_BSDF, 2)}).cause, NoiseCause::caustic) << "seen through glass";
    EXPECT_EQ(
        report_of({light_of(9, RT_BY_NEE, 1, kSky, 40, RT_FIRST_GLOSSY), event_of(RT_FIRST_GLOSSY, 1, 0, 40)}, 1, "nee").cause,
        NoiseCause::lobe);
    EXPECT_EQ(report_of({light_of(9, RT_BY_NEE, 6)}).cause, NoiseCause::deep);
    EXPECT_EQ(report_of({light_of(9, RT_BY_BSDF, 0, 0, 0, RT_PATH_NO_EVENT)}).cause, NoiseCause::edge);
    EXPECT_EQ(report_of({light_of(9, RT_BY_NEE, 2)}).cause, NoiseCause::mixed);
    Replay many;
    for (int s = 0; s < 1000; ++s) add_sample(many, {light_of(s % 20 ? 0.1f : 30.0f, RT_BY_NEE, 1, s % 20)});
    EXPECT_EQ(noise_report(many, names_of(20)).cause, NoiseCause::lights);
}

TEST(Noise, PixelsWithoutTroubleAreNotAccused) {
    Replay even, black, equal;
    for (int s = 0; s < 100; ++s) {
        add_sample(even, {light_of(1 + 0.5f * float(s % 3), RT_BY_NEE, 1)});
        add_sample(black, {event_of(RT_FIRST_DIFFUSE, 1)});
        add_sample(equal, {light_of(0.1f, RT_BY_NEE, 1), light_of(0.7f, RT_BY_BSDF, 1)});
    }
    EXPECT_EQ(noise_report(even, names_of(1)).cause, NoiseCause::quiet);
    EXPECT_EQ(noise_report(black, names_of(1)).cause, NoiseCause::black);
    const NoiseReport flat = noise_report(equal, names_of(1));
    EXPECT_EQ(flat.cause, NoiseCause::quiet);
    EXPECT_EQ(flat.variance, 0) << "what is rounded is no variance";
    EXPECT_EQ(noise_report({}, names_of(1)).cause, NoiseCause::black) << "no sample";
}

TEST(Noise, SamplesThatAreNoNumberCountInNoFigure) {
    Replay replay;
    for (int s = 0; s < 10; ++s)
        add_sample(replay, {light_of(s == 7 ? std::numeric_limits<float>::quiet_NaN() : float(s % 2), RT_BY_NEE, 1)});
    const NoiseReport report = noise_report(replay, names_of(1));
    EXPECT_EQ(report.cause, NoiseCause::not_finite);
    EXPECT_EQ(report.not_finite, 1u);
    EXPECT_EQ(report.brightest.front(), 7u);
    EXPECT_NEAR(report.luminance, 4.0 / 9, 1e-6);
    EXPECT_NEAR(sum_of(report.by_light, &NoiseShare::of_variance), 1, 1e-12);
}

TEST(Noise, TheTableHasALineForEachRecord) {
    Replay replay;
    add_sample(replay, {event_of(RT_FIRST_GLOSSY, 1, RT_PATH_SMOOTH), light_of(2.5f, RT_BY_BSDF, 1, kSky, 0.5f)});
    add_sample(replay, {light_of(1, RT_BY_NEE, 1)});
    NoiseNames names = names_of(1);
    names.lights[0] = "a \"b\"";
    const std::string text = paths_csv(replay, {1, 0}, names, Scene{});
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
    EXPECT_NE(text.find("\n1,lit,1,0,0,0,0,nee,\"lamp `a \"\"b\"\"`\",,0,0,0,0.2,0,1,1,1,1\n"), std::string::npos) << text;
    EXPECT_NE(text.find("\n0,scatters,1,0,0,0,0,glossy smooth,,"), std::string::npos) << text;
}

}  // namespace
