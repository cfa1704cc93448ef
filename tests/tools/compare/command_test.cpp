// command_test.cpp -- `clarity compare`.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/pictures/image_io.hpp"
#include "base/pictures/picture_read.hpp"
#include "cli/run_program.hpp"
#include "support/scratch.hpp"

using namespace clarity;

namespace {

std::string flat(const Scratch& scratch, const std::string& name, unsigned width, float value) {
    FloatImage image{width, 4, 3, {}};
    image.pixels.assign(size_t(width) * 12, value);
    write_image(scratch.path(name), image, {});
    return scratch.path(name);
}

TEST(Compare, WritesFiguresAndAPicture) {
    const Scratch scratch;
    const std::string a = flat(scratch, "a.pfm", 8, .75f), b = flat(scratch, "b.pfm", 8, .5f), diff = scratch.path("diff.png");
    const ProgramResult text = run_program({"compare", a, b, "-o", diff});
    ASSERT_EQ(text.exit_code, 0) << text.err;
    EXPECT_NE(text.out.find("rmse            0.25\n"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("mean_ratio      1.5\n"), std::string::npos) << text.out;
    EXPECT_TRUE(read_picture(diff).pixels[0] == 1 && read_picture(diff).pixels[2] == 0) << "red: brighter";
    const ProgramResult json = run_program({"compare", a, b, "--json"});
    const auto read = nlohmann::json::parse(json.out);
    EXPECT_EQ(read.at("rmse"), .25);
    EXPECT_EQ(read.at("width"), 8);
    EXPECT_GT(read.at("flip"), .1);
}

TEST(Compare, RefusesWithAReason) {
    const Scratch scratch;
    const std::string a = flat(scratch, "a.pfm", 8, .75f), b = flat(scratch, "b.pfm", 9, .5f);
    const ProgramResult sizes = run_program({"compare", a, b});
    EXPECT_EQ(sizes.exit_code, 1);
    EXPECT_NE(sizes.err.find("8x4 and 9x4"), std::string::npos) << sizes.err;
    const ProgramResult missing = run_program({"compare", a, scratch.path("none.exr")});
    EXPECT_EQ(missing.exit_code, 1);
    EXPECT_NE(missing.err.find("none.exr"), std::string::npos) << missing.err;
    EXPECT_EQ(run_program({"compare", a, a, "-o", scratch.path("diff.pfm")}).exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(scratch.path("diff.pfm")));
}

}  // namespace
