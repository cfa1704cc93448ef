// goal_test.cpp -- `clarity render --error` and `--time-budget`: pictures end when they are good enough, or when time is over.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/clock.hpp"
#include "support/scratch.hpp"

namespace {

class Goal : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scene_ = scratch_.write("a.scene",
                                "camera main eye 0 1 4 target 0 1 0 fov 40\n"
                                "light rect center 0 3 0 u 1 0 0 v 0 0 1 radiance 4 4 4\n"
                                "material white model lambert color .7 .7 .7\n"
                                "plane normal 0 1 0 offset 0 material white\n"
                                "sphere center 0 1 0 radius .7 material white\n");
    }
    ProgramResult render(const std::vector<std::string>& more) const {
        std::vector<std::string> all = {"render",   scene_,
                                        "--size",   "32x24",
                                        "--tracer", "path",
                                        "-o",       scratch_.path("a.pfm"),
                                        "--stats",  scratch_.path("s.json")};
        all.insert(all.end(), more.begin(), more.end());
        return run_program(all);
    }
    nlohmann::json stats(const std::vector<std::string>& more) const {
        const ProgramResult result = render(more);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return nlohmann::json::parse(scratch_.read("s.json"));
    }
    Scratch scratch_;
    std::string scene_;
};

TEST_F(Goal, AnErrorIsReachedWithTheSamplesThatItTakes) {
    render({"--spp", "20000", "--seed", "7"});
    scratch_.write("reference.pfm", scratch_.read("a.pfm"));
    const auto reach = [&](const char* error) {
        return stats({"--error", error, "--sampler", "independent", "--reference", scratch_.path("reference.pfm")});
    };
    const nlohmann::json coarse = reach("8%"), fine = reach("0.02");
    for (const auto& [run, goal] : {std::pair{&coarse, 0.08}, {&fine, 0.02}}) {
        const double estimated = (*run)["estimated_error"];
        EXPECT_LE(estimated, goal);
        EXPECT_GT(estimated, 0.6 * goal) << "many more samples than needed: " << (*run)["samples"];
        const nlohmann::json& end = (*run)["reference"]["points"].back();
        // RMSE is over three channels and the estimate of luminance: alike in this gray scene.
        EXPECT_NEAR(end["rmse"].get<double>() / end["mean"].get<double>() / estimated, 1, 0.15);
    }
    const double ratio = fine["samples"].get<double>() / coarse["samples"].get<double>();
    EXPECT_GT(ratio, 9);
    EXPECT_LT(ratio, 25);
    EXPECT_EQ(reach("0.02")["samples"], fine["samples"]) << "it depends on nothing but the picture";
    EXPECT_EQ(stats({"--error", "1e-6", "--spp", "20"})["samples"], 20) << "--spp is the most";
}

TEST_F(Goal, ATimeIsKept) {
    const nlohmann::json some = stats({"--time-budget", "0.3"}), more = stats({"--time-budget", "1.2"});
    EXPECT_GT(some["samples"], 0);
    const nlohmann::json least = stats({"--time-budget", "0.001", "--spp", "100000"});
    EXPECT_GT(least.value("samples", 0), 0);
    EXPECT_GT(more["samples"], least["samples"]);
    if (clarity::test::clocks_count()) {
        EXPECT_GT(more["samples"], some["samples"]);
    }
}

TEST_F(Goal, IsRecorded) {
    ASSERT_EQ(render({"--error", ".1", "--skip-existing"}).exit_code, 0);
    const nlohmann::json record = nlohmann::json::parse(scratch_.read("a.json"));
    EXPECT_EQ(record["samples"], nlohmann::json::parse(scratch_.read("s.json"))["samples"]);
    const ProgramResult verified = run_program({"render", "--verify", scratch_.path("a.json")});
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
    ASSERT_EQ(render({"--time-budget", ".1", "--skip-existing"}).exit_code, 0);
    const ProgramResult timed = run_program({"render", "--verify", scratch_.path("a.json")});
    EXPECT_EQ(timed.exit_code, 1);
    EXPECT_NE((timed.out + timed.err).find("--time-budget"), std::string::npos) << timed.out << timed.err;
}

// The picture ends when all pixels have samples enough, and says how many they are.
TEST_F(Goal, PixelsRest) {
    const nlohmann::json coarse = stats({"--adaptive", ".2"}), fine = stats({"--adaptive", ".05"});
    for (const auto& [run, bound] : {std::pair{&coarse, 0.2}, {&fine, 0.05}}) {
        EXPECT_EQ((*run)["adaptive"], bound);
        EXPECT_LE((*run)["estimated_error"], bound) << "no pixel has more of its light";
        EXPECT_LT((*run)["mean_samples"], 0.8 * (*run)["samples"].get<double>());
    }
    EXPECT_GT(fine["mean_samples"], 4 * coarse["mean_samples"].get<double>());
    EXPECT_LT(stats({"--adaptive", ".05", "--error", ".1"})["samples"], fine["samples"]);
    EXPECT_EQ(stats({"--adaptive", ".05", "--spp", "50"})["samples"], 50) << "--spp is the most";
    EXPECT_EQ(stats({"--adaptive", "0", "--spp", "50"}).contains("adaptive"), false);
}

TEST_F(Goal, ThePictureSaysHowGoodItIs) {
    const ProgramResult result = render({"--adaptive", ".2", "-o", scratch_.path("b.png")});
    ASSERT_EQ(result.exit_code, 0);
    const nlohmann::json run = nlohmann::json::parse(scratch_.read("s.json"));
    char line[96];
    std::snprintf(line, sizeof line, "  %.4g samples a pixel on average, %u at most", run["mean_samples"].get<double>(),
                  run["samples"].get<unsigned>());
    EXPECT_NE(result.err.find(line), std::string::npos) << result.err;
    const std::string png = scratch_.read("b.png");
    const auto number = [&](const std::string& key) {
        const size_t at = png.find(key + std::string(1, '\0'));
        return at == std::string::npos ? -1 : std::stod(png.substr(at + key.size() + 1, 20));
    };
    EXPECT_NEAR(number("Samples"), run["mean_samples"].get<double>(), 1e-3);
    EXPECT_NEAR(number("Estimated error"), run["estimated_error"].get<double>(), 1e-6);
}

// A picture of the same seconds is done, however many samples they were enough for.
TEST_F(Goal, IsSkippedIfItIsTheSame) {
    const auto tells = [&](const std::vector<std::string>& goal) {
        std::vector<std::string> all = goal;
        all.emplace_back("--skip-existing");
        return render(all).err.find("were there already") != std::string::npos;
    };
    EXPECT_FALSE(tells({"--time-budget", ".1"}));
    EXPECT_TRUE(tells({"--time-budget", ".1"}));
    EXPECT_FALSE(tells({"--time-budget", ".2"}));
    EXPECT_FALSE(tells({"--adaptive", ".2"}));
    EXPECT_FALSE(tells({"--adaptive", ".3"}));
    EXPECT_TRUE(tells({"--adaptive", ".3"}));
}

// A picture without its noise is another picture, and says that it is biased; `moving` is for the window.
TEST_F(Goal, ADenoisedPictureSaysSo) {
    const auto of = [&](const char* denoise) {
        const nlohmann::json run = stats({"--spp", "4", "--denoise", denoise, "--skip-existing"});
        return std::pair{run.value("denoised", false), scratch_.read("a.pfm")};
    };
    const auto off = of("off"), on = of("on");
    EXPECT_FALSE(off.first);
    EXPECT_TRUE(on.first);
    EXPECT_EQ(off.second.size(), on.second.size());
    EXPECT_NE(off.second, on.second) << "the first one was not taken for it";
    EXPECT_EQ(of("off").second, off.second);
    EXPECT_NE(render({"--spp", "4", "--skip-existing"}).err.find("were there already"), std::string::npos) << "moving";
    for (const char* denoise : {"on", "moving"}) {
        ASSERT_EQ(render({"--spp", "4", "--denoise", denoise, "-o", scratch_.path("b.png")}).exit_code, 0);
        EXPECT_EQ(scratch_.read("b.png").find("Denoised") != std::string::npos, std::string(denoise) == "on");
    }
}

TEST_F(Goal, ThatNobodyCanKeepIsRefused) {
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"--error", ".1", "--tracer", "iterative"},
                                               {"--error", ".1", "--aov", "error"},
                                               {"--error", "0"},
                                               {"--adaptive", "-1"},
                                               {"--time-budget", "-1"},
                                               {"--error", ".1", "--repeat", "2"},
                                               {"--time-budget", "1", "--repeat", "2"}})
        EXPECT_EQ(render(words).exit_code, 2) << words[0] << " " << words[1];
}

}  // namespace
