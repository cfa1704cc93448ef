// crop_test.cpp -- `clarity render --crop`: a part of a picture has the pixels of the whole.
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

// The rows of a PFM from the top, as bytes.
struct Rows {
    unsigned width = 0, height = 0, pixel_bytes = 0;
    std::string bytes;
    std::string part(unsigned x, unsigned y, unsigned w, unsigned h) const {
        std::string part;
        for (unsigned row = y; row < y + h; ++row)
            part +=
                bytes.substr(size_t(height - 1 - row) * width * pixel_bytes + size_t(x) * pixel_bytes, size_t(w) * pixel_bytes);
        return part;
    }
};
Rows rows_of(const std::string& pfm) {
    Rows rows;
    std::istringstream head(pfm);
    std::string kind, scale;
    head >> kind >> rows.width >> rows.height >> scale;
    rows.pixel_bytes = kind == "PF" ? 12 : 4;
    rows.bytes = pfm.substr(size_t(head.tellg()) + 1);
    EXPECT_EQ(rows.bytes.size(), size_t(rows.width) * rows.height * rows.pixel_bytes);
    return rows;
}

class Crop : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
    }
    std::string scene(const char* more) const {
        return scratch_.write("a.scene", std::string("camera main eye 0 1 6 target .3 1 0 fov 40\n"
                                                     "light point position 3 6 4\n"
                                                     "material mirror color .2 .2 .2 reflect .8\n"
                                                     "material lamp emission 3 2 1\n"
                                                     "sphere center 0 1 0 radius 1 material mirror\n"
                                                     "sphere center 1 2 1 radius .3 material lamp\n") +
                                             more);
    }
    std::string render(const std::string& file, std::vector<std::string> more, int code = 0) const {
        std::vector<std::string> all = {"render", file, "--size", "75x53", "-o", scratch_.path("a.pfm")};
        all.insert(all.end(), more.begin(), more.end());
        const ProgramResult result = run_program(all);
        EXPECT_EQ(result.exit_code, code) << result.err;
        return code == 0 ? scratch_.read("a.pfm") : result.err;
    }
    Scratch scratch_;
};

struct Way {
    const char* name;
    const char* more;
    std::vector<std::string> words;
};
class CropWays : public Crop, public ::testing::WithParamInterface<Way> {};

TEST_P(CropWays, HaveThePixelsOfTheWhole) {
    const Way& way = GetParam();
    const std::string file = scene(way.more);
    const Rows whole = rows_of(render(file, way.words));
    for (const auto& [x, y, w, h] : {std::array<unsigned, 4>{21, 9, 33, 18}, {74, 52, 1, 1}}) {
        std::vector<std::string> words = way.words;
        const std::string crop =
            std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(w) + "," + std::to_string(h);
        words.insert(words.end(), {"--crop", crop});
        const Rows part = rows_of(render(file, words));
        EXPECT_EQ(part.width, w);
        EXPECT_EQ(part.height, h);
        EXPECT_TRUE(part.part(0, 0, w, h) == whole.part(x, y, w, h)) << crop;
    }
}

// With a plane and without: a packet that misses everything is known before it is traced only without.
constexpr const char* kPlane = "plane normal 0 1 0 offset 0\n";
INSTANTIATE_TEST_SUITE_P(, CropWays,
                         testing::Values(Way{"Packets", "", {"--spp", "3"}}, Way{"PacketsOverAPlane", kPlane, {"--spp", "1"}},
                                         Way{"Wavefront", "", {"--tracer", "wavefront"}},
                                         Way{"Paths", kPlane, {"--tracer", "path", "--spp", "5"}},
                                         Way{"Distances", "", {"--aov", "t"}},
                                         Way{"TwoDevices", "", {"--device", "cpu/2", "--spp", "2"}}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_F(Crop, IsRecordedAndComparedWithTheWhole) {
    const std::string file = scene("");
    const std::vector<std::string> way = {"--tracer", "path", "--spp", "4"};
    scratch_.write("whole.pfm", render(file, way));
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), way.begin(), way.end());
        return more;
    };
    render(file,
           with({"--crop", "10,11,30,20", "--reference", scratch_.path("whole.pfm"), "--stats", scratch_.path("s.json")}));
    const nlohmann::json stats = nlohmann::json::parse(scratch_.read("s.json"));
    EXPECT_EQ(stats["size"], "30x20");
    EXPECT_EQ(stats["crop"]["of"], "75x53");
    EXPECT_EQ(stats["reference"]["points"].back()["rmse"], 0.0) << stats["reference"].dump();

    render(file, with({"--crop", "10,11,30,20", "--skip-existing"}));
    const ProgramResult verified = run_program({"render", "--verify", scratch_.path("a.json")});
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
    // Another part is another picture.
    render(file, with({"--crop", "0,0,30,20", "--skip-existing"}));
    EXPECT_TRUE(rows_of(scratch_.read("a.pfm")).part(0, 0, 30, 20) == rows_of(scratch_.read("whole.pfm")).part(0, 0, 30, 20));
}

TEST_F(Crop, MustLieWithinThePicture) {
    const std::string file = scene("");
    for (const char* crop : {"0,0,76,1", "75,0,1,1", "-1,0,5,5", "0,0,0,5", "0,0,5", "a", "1,2,3,4,5", "2147483647,0,5,5"})
        EXPECT_NE(render(file, {"--crop", crop}, 2).find("75x53"), std::string::npos) << crop;
}

}  // namespace
