// why_test.cpp -- `clarity why`: planted causes of noise are named, its samples are those of `clarity render` bit for bit, also
// with motion blur and a lens, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/pictures/picture_read.hpp"
#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

using Json = nlohmann::json;

constexpr const char* kFloor =
    "background 0 0 0\ncamera main eye 0 2 6 target 0 0 0 fov 40\nmaterial floor model lambert color .7\n"
    "plane normal 0 1 0 offset 0 material floor\n";
const std::string kLamp = std::string(kFloor) + "light sphere center 1 3 1 radius .1 radiance 3000 name bulb\n";
const std::string kCaustic = std::string(kFloor) +
                             "light sphere center 0 6 -2 radius .2 radiance 300 name bulb\nmaterial clear model dielectric "
                             "color 1 ior 1.5\nsphere center 0 1.2 -.4 radius 1 material clear\n";
constexpr const char* kLobe =
    "camera main eye 0 2 6 target 0 0 0 fov 40\nsky gradient zenith .2 .4 1 horizon 1 .9 .8 ground .1 .1 .1\n"
    "material metal model conductor color .9 roughness .15\nplane normal 0 1 0 offset 0 material metal\n";
// A corridor with two turns between the camera and the lamp.
constexpr const char* kDeep =
    "background 0 0 0\ncamera main eye 0 1 0 target 0 1 -1 fov 40\nmaterial wall model lambert color .85\n"
    "light sphere center 0 1 8 radius .3 radiance 200 name lamp\n"
    "polygon material wall vertices -1 0 -2  1 0 -2  1 2 -2  -1 2 -2\n"
    "polygon material wall vertices -1 0 -2  -1 0 10  -1 2 10  -1 2 -2\n"
    "polygon material wall vertices 1 0 -2  1 0 10  1 2 10  1 2 -2\n"
    "polygon material wall vertices -1 0 -2  1 0 -2  1 0 10  -1 0 10\n"
    "polygon material wall vertices -1 2 -2  1 2 -2  1 2 10  -1 2 10\n"
    "polygon material wall vertices -1 0 10  1 0 10  1 2 10  -1 2 10\n"
    "polygon material wall vertices -1 0 2  .3 0 2  .3 2 2  -1 2 2\n"
    "polygon material wall vertices -.3 0 4  1 0 4  1 2 4  -.3 2 4\n";

// Lamps on a spiral around the pixel, close to the floor.
std::string many_lamps() {
    std::string text = kFloor;
    for (int i = 0; i < 64; ++i) {
        const double angle = 2.399963 * i, radius = 0.4 + 0.35 * i;
        text += "light sphere center " + std::to_string(radius * std::cos(angle)) + " .6 " +
                std::to_string(radius * std::sin(angle)) + " radius .05 radiance 300 name lamp" + std::to_string(i) + "\n";
    }
    return text;
}

class Why : public testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
    }
    Json why(const std::string& scene, const std::vector<std::string>& more) const {
        std::vector<std::string> all = {"why", scratch_.write("a.scene", scene), "--size", "64x48", "--json"};
        all.insert(all.end(), more.begin(), more.end());
        const ProgramResult result = run_program(all);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.exit_code == 0 ? Json::parse(result.out) : Json();
    }
    void expect_cause(const std::string& scene, const std::string& cause, std::vector<std::string> more,
                      const std::vector<std::string>& words) const {
        more.insert(more.end(), {"--pixel", "32,24"});
        const Json json = why(scene, more);
        ASSERT_FALSE(json.is_null());
        const std::string sentence = json["sentence"];
        EXPECT_EQ(json["cause"], cause) << sentence;
        for (const std::string& word : words) EXPECT_NE(sentence.find(word), std::string::npos) << sentence;
        for (const char* kind : {"by_bounce", "by_lobe", "by_strategy", "by_light"}) {
            double sum = 0;
            for (const Json& share : json[kind]) sum += double(share["of_variance"]);
            EXPECT_NEAR(sum, 1, 1e-9) << kind;
        }
    }
    Scratch scratch_;
};

TEST_F(Why, NamesALampThatIsSeldomFound) {
    expect_cause(kLamp, "lamp", {"--strategy", "bsdf", "--samples", "4096"},
                 {"lamp `bulb`", "of 4096 samples", "--strategy mis"});
    expect_cause(kLamp, "quiet", {}, {"not noisy", "1024 samples"});
    EXPECT_FALSE(why(kLamp, {"--pixel", "32,24"}).contains("picture_may_have_fewer"));
    EXPECT_TRUE(why(kLamp, {"--pixel", "32,24", "--adaptive", ".1"}).contains("picture_may_have_fewer"));
}

TEST_F(Why, NamesPlantedCauses) {
    for (const char* seed : {"0", "5"}) {
        expect_cause(kCaustic, "caustic", {"--seed", seed}, {"lamp `bulb`", "caustic"});
        expect_cause(kLobe, "lobe", {"--seed", seed, "--strategy", "nee"}, {"the sky", "narrow", "--strategy mis"});
        expect_cause(many_lamps(), "lights", {"--seed", seed}, {"many lights"});
        expect_cause(kDeep, "deep", {"--seed", seed, "--depth", "16"}, {"deep bounces"});
        expect_cause(std::string(kFloor) + "light rect center -1 4 -1 u 2 0 0 v 0 0 2 radiance 8\n", "quiet", {"--seed", seed},
                     {});
        expect_cause(kLobe, "quiet", {"--seed", seed}, {});
    }
}

// The mean of the samples is the picture's pixel, though the scene moves while the shutter is open, the lens is wide, and
// packets, lanes and the number of samples in a launch are others.
TEST_F(Why, TracesTheSamplesOfAPicture) {
    scratch_.write("box.obj", "v -.5 -.5 0\nv .5 -.5 0\nv .5 .5 0\nv -.5 .5 0\nf 1 2 3 4\n");
    const std::string scene =
        "camera main eye 0 0 9 target 0 0 0 fov 40 aperture .4 focus 8\nlight sphere center 0 2 6 radius .5 radiance 40\n"
        "material matt model lambert color .8 .6 .4\nload box.obj name box material matt\n"
        "animate box translate 0 -2 0 0  1 2 0 0\nplane normal 0 1 0 offset -1 material matt\n";
    const std::vector<std::string> blur = {"--time", "0.5", "--spp", "12", "--shutter", "1", "--fps", "2", "--lanes", "8"};
    std::vector<std::string> render = {
        "render", scratch_.write("b.scene", scene), "-o", scratch_.path("b.pfm"), "--tracer", "path", "--size", "64x48"};
    render.insert(render.end(), blur.begin(), blur.end());
    ASSERT_EQ(run_program(render).exit_code, 0);
    const clarity::FloatImage picture = clarity::read_picture(scratch_.path("b.pfm"));
    for (const char* pixel : {"32,24", "29,23", "37,30"}) {
        std::vector<std::string> more = blur;
        more.insert(more.end(), {"--pixel", pixel, "--packet", "4x4"});
        const Json json = why(scene, more);
        ASSERT_FALSE(json.is_null());
        ASSERT_EQ(json["samples"], 12);
        const size_t at = size_t(json["pixel"][1]) * 64 + size_t(json["pixel"][0]);
        double light = 0;
        for (size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(float(json["mean"][k]), picture.pixels[3 * at + k]) << pixel;
            light += picture.pixels[3 * at + k];
        }
        EXPECT_GT(light, 0) << pixel;
    }
}

TEST_F(Why, ReadsThePicturesOfEdits) {
    const std::string picture = scratch_.write("red.ppm", std::string("P6 1 1 255\n\xff") + std::string(2, '\0'));
    const Json json = why(kLamp, {"--pixel", "32,24", "--samples", "16", "--set", "material.1.color_map=" + picture});
    EXPECT_EQ(json["samples"], 16);
}

TEST_F(Why, WritesTheBrightestPaths) {
    const std::string csv = scratch_.path("paths.csv");
    const Json json = why(kCaustic, {"--pixel", "32,24", "--csv", csv});
    ASSERT_FALSE(json.is_null());
    const std::string text = scratch_.read("paths.csv");
    EXPECT_EQ(text.rfind("sample,kind,bounce,x,y,z,", 0), 0u) << text;
    EXPECT_EQ(json["brightest"].size(), 10u);
    for (const Json& sample : json["brightest"])
        EXPECT_NE(text.find("\n" + sample.dump() + ",begins,0,"), std::string::npos) << sample;
    EXPECT_NE(text.find("transmission smooth,,\"clear\""), std::string::npos) << text.substr(0, 2000);
}

// Of `sobol` the first two dimensions of a set have one point in each of 16 x 16 cells; `independent` leaves cells empty.
TEST_F(Why, WritesTheNumbersOfTheSampler) {
    for (const std::string sampler : {"sobol", "independent"}) {
        const std::string file = scratch_.path(sampler + ".csv");
        const Json json =
            why(kLamp, {"--pixel", "32,24", "--samples", "256", "--depth", "2", "--sampler", sampler, "--points", file});
        ASSERT_FALSE(json.is_null());
        std::istringstream lines(scratch_.read(sampler + ".csv"));
        std::string line;
        std::getline(lines, line);
        EXPECT_EQ(line.rfind("sample,pixel x,pixel y,lens u,lens v,event 1 lobe,event 1 direction u,", 0), 0u) << line;
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), 4 + 2 * 8);
        std::set<std::pair<int, int>> pixel, light;
        int samples = 0;
        while (std::getline(lines, line)) {
            std::vector<double> fields;
            std::istringstream words(line);
            for (std::string word; std::getline(words, word, ',');) fields.push_back(std::stod(word));
            ASSERT_EQ(fields.size(), 21u);
            EXPECT_EQ(fields[0], samples++);
            for (size_t i = 1; i < fields.size(); ++i) ASSERT_TRUE(fields[i] >= 0 && fields[i] < 1) << line;
            pixel.emplace(int(fields[1] * 16), int(fields[2] * 16));
            light.emplace(int(fields[9] * 16), int(fields[10] * 16));
        }
        EXPECT_EQ(samples, 256);
        EXPECT_EQ(pixel.size() == 256, sampler == "sobol");
        EXPECT_EQ(light.size() == 256, sampler == "sobol");
    }
}

TEST_F(Why, RefusesWhatItCannotDo) {
    const std::string scene = scratch_.write("a.scene", kLamp);
    const auto refused = [&](const std::vector<std::string>& more, const char* why) {
        std::vector<std::string> all = {"why", scene, "--size", "64x48"};
        all.insert(all.end(), more.begin(), more.end());
        const ProgramResult result = run_program(all);
        EXPECT_EQ(result.exit_code, 2) << why;
        EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    };
    refused({}, "--pixel");
    refused({"--pixel", "64,0"}, "64x48");
    refused({"--pixel", "7"}, "expected x,y");
    refused({"--pixel", "-1,2"}, "expected x,y");
    refused({"--pixel", "1,2", "--tracer", "iterative"}, "leave it out");
    refused({"--pixel", "1,2", "--aov", "t"}, "leave it out");
    refused({"--pixel", "1,2", "--samples", "1"}, "--samples");
    refused({"--pixel", "1,2", "--spp", "100000"}, "65536");
}

}  // namespace
