// paths_test.cpp -- `clarity render --tracer path` from outside: the same bytes however it is traced, parts of its light, and
// how far it is from a reference.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/pictures/picture_read.hpp"
#include "cli/run_program.hpp"
#include "support/quick.hpp"
#include "support/scratch.hpp"

using clarity::FloatImage;
using clarity::test::quick;

namespace {

class Paths : public testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scratch_.write("a.scene",
                       "camera main eye 0 1 6 target 0 1 0 fov 40\nbackground .2 .3 .4\n"
                       "light sphere center 3 6 4 radius 1 radiance 9\n"
                       "material metal model conductor color .8 .6 .3 roughness .4\nmaterial clear model dielectric color 1\n"
                       "material matt model lambert color .6\nplane normal 0 1 0 offset 0 material matt\n"
                       "sphere center -1.1 1 0 radius 1 material metal\nsphere center 1.1 1 0 radius 1 material clear\n");
    }
    ProgramResult render(const std::string& output, const std::vector<std::string>& more,
                         const RunOptions& options = {}) const {
        std::vector<std::string> all = {"render",   scratch_.path("a.scene"),
                                        "-o",       scratch_.path(output),
                                        "--tracer", "path",
                                        "--size",   "61x47",
                                        "--lanes",  "8",
                                        "--depth",  "3",
                                        "--spp",    "12"};
        all.insert(all.end(), more.begin(), more.end());
        return run_program(all, options);
    }
    FloatImage picture(const std::vector<std::string>& more) const {
        const ProgramResult result = render("picture.pfm", more);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return clarity::read_picture(scratch_.path("picture.pfm"));
    }
    Scratch scratch_;
};

double sum_of(const FloatImage& image) {
    double sum = 0;
    for (const float value : image.pixels) sum += value;
    return sum;
}

TEST_F(Paths, OfSeveralDevicesHaveTheBytesOfOne) {
    ASSERT_EQ(render("one.pfm", {"--device", "cpu"}).exit_code, 0);
    std::vector<std::string> devices = {"cpu/2"};
    if (!quick()) devices.insert(devices.end(), {"cpu/2.1", "cpu,cpu/2.0,cpu/2.1"});
    if (!quick() && std::thread::hardware_concurrency() >= 4) devices.insert(devices.end(), {"cpu/3", "cpu/4"});
    for (const std::string& device : devices) {
        const ProgramResult result = render("several.pfm", {"--device", device});
        ASSERT_EQ(result.exit_code, 0) << device << ": " << result.err;
        EXPECT_EQ(scratch_.read("several.pfm"), scratch_.read("one.pfm")) << device;
    }
    if (!quick()) {  // other kernels
        ASSERT_EQ(render("packets.pfm", {"--packet", "3x5", "--accel", "bvh4"}).exit_code, 0);
        EXPECT_EQ(scratch_.read("packets.pfm"), scratch_.read("one.pfm"));
    }
    ASSERT_EQ(render("other.pfm", {"--seed", "2"}).exit_code, 0);
    EXPECT_NE(scratch_.read("other.pfm"), scratch_.read("one.pfm"));
}

TEST_F(Paths, GoOnFromACheckpointOnOtherDevices) {
    const std::vector<std::string> longer = {"--spp", "4000"};
    ASSERT_EQ(render("whole.pfm", longer).exit_code, 0);
    RunOptions options;
    options.signal = SIGTERM;
    options.signal_when = "samples";  // of the first checkpoint
    const std::string film = scratch_.path("a.film");
    ProgramResult result = render("a.pfm", {"--spp", "4000", "--checkpoint", film, "--every", "0.1", "-v"}, options);
    ASSERT_EQ(result.exit_code, 130) << result.err;
    result = render("b.pfm", {"--spp", "4000", "--resume", film, "--sampler", "independent"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("is a checkpoint of another picture"), std::string::npos) << result.err;
    result = render("a.pfm", {"--spp", "4000", "--resume", film, "--device", "cpu/2"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("goes on after"), std::string::npos) << result.err;
    EXPECT_EQ(scratch_.read("a.pfm"), scratch_.read("whole.pfm"));
}

TEST_F(Paths, PartsOfTheirLightAddUp) {
    const FloatImage whole = picture({});
    const auto expect_parts = [&](const std::vector<std::string>& parts) {
        std::vector<double> sum(whole.pixels.size());
        for (const std::string& part : parts) {
            const FloatImage image = picture({"--only-paths", part});
            EXPECT_GT(sum_of(image), 0.1) << part << ": an empty part proves nothing";
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += image.pixels[i];
        }
        double worst = 0;
        for (size_t i = 0; i < sum.size(); ++i) worst = std::max(worst, std::fabs(sum[i] - whole.pixels[i]));
        EXPECT_LT(worst, 1e-5) << parts[0];
    };
    expect_parts({"bounce=0", "bounce=1", "bounce=2", "bounce=3"});
    expect_parts({"by=nee", "by=bsdf"});
    expect_parts({"bounce=0", "first=diffuse", "first=glossy", "first=transmission"});
    EXPECT_LT(sum_of(picture({"--only-paths", "light=0"})), 0.9 * sum_of(whole)) << "the rest is the sky's";
    for (const char* wrong : {"bounce", "by=luck", "colour=1", "bounce=1,"}) {
        const ProgramResult result = render("x.pfm", {"--only-paths", wrong});
        EXPECT_EQ(result.exit_code, 2) << wrong;
        EXPECT_FALSE(std::filesystem::exists(scratch_.path("x.pfm"))) << wrong;
    }
}

TEST_F(Paths, ComeNearAReference) {
    const std::vector<std::string> independent = {"--sampler", "independent", "--spp", "256"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), independent.begin(), independent.end());
        return more;
    };
    ASSERT_EQ(render("reference.pfm", with({"--seed", "5"})).exit_code, 0);
    const ProgramResult result = render("a.pfm", with({"--reference", scratch_.path("reference.pfm"), "--stats", "-"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto reference = nlohmann::json::parse(result.out).at("reference");
    const auto& points = reference.at("points");
    ASSERT_EQ(points.size(), 8u) << "2, 4 .. 256 samples";
    EXPECT_EQ(points.back().at("samples"), 256);
    EXPECT_NEAR(points.back().at("mean_ratio"), 1, 0.05);
    EXPECT_LT(points.back().at("rmse"), points.front().at("rmse").get<double>() / 3);
    EXPECT_LT(reference.at("slope"), -0.3);
    // What `clarity compare` says of the file.
    const ProgramResult compared = run_program({"compare", scratch_.path("a.pfm"), scratch_.path("reference.pfm"), "--json"});
    EXPECT_NEAR(nlohmann::json::parse(compared.out).at("rmse").get<double>(), points.back().at("rmse").get<double>(), 1e-9);
    // The same seed and number of samples: no error is left.
    const ProgramResult same =
        render("a.pfm", with({"--seed", "5", "--reference", scratch_.path("reference.pfm"), "--stats", "-"}));
    EXPECT_EQ(nlohmann::json::parse(same.out).at("reference").at("points").back().at("rmse"), 0);
    const ProgramResult size = render("x.pfm", {"--reference", scratch_.path("reference.pfm"), "--size", "62x47"});
    EXPECT_EQ(size.exit_code, 2);
    EXPECT_NE(size.err.find("take --size 61x47"), std::string::npos) << size.err;
    const ProgramResult missing = render("x.pfm", {"--reference", scratch_.path("none.pfm")});
    EXPECT_NE(missing.exit_code, 0);
    EXPECT_NE(missing.err.find("none.pfm"), std::string::npos) << missing.err;
}

}  // namespace
