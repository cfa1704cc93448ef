// checkpoint_test.cpp -- a checkpoint comes back bit for bit, and a file that is not one is refused.
#include "stand/checkpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "base/error.hpp"
#include "support/errors.hpp"
#include "support/scratch.hpp"

using namespace clarity;

namespace {

Checkpoint sample_checkpoint() {
    FloatImage sums{7, 5, 4, {}};
    for (size_t i = 0; i < 7 * 5 * 4; ++i) sums.pixels.push_back(std::ldexp(1.0f + float(i) * 0.013f, int(i % 41) - 20));
    sums.pixels[3] = std::numeric_limits<float>::infinity();
    sums.pixels[4] = std::numeric_limits<float>::quiet_NaN();
    return {"0123456789abcdef", "a device, bvh8", 388, 4000, 1, std::make_shared<const FloatImage>(sums)};
}

std::string why_refused(const std::string& path) {
    return expect_error([&] { load_checkpoint(path); }, {path}, Exit::failed);
}

}  // namespace

TEST(Checkpoint, ComesBack) {
    const Scratch scratch;
    const Checkpoint saved = sample_checkpoint();
    save_checkpoint(scratch.path("a"), saved);
    const Checkpoint back = load_checkpoint(scratch.path("a"));
    EXPECT_EQ(back.picture, saved.picture);
    EXPECT_EQ(back.way, saved.way);
    EXPECT_EQ(back.samples, 388u);
    EXPECT_EQ(back.of, 4000u);
    EXPECT_EQ(back.sums->width, 7u);
    EXPECT_EQ(back.sums->height, 5u);
    ASSERT_EQ(back.sums->pixels.size(), saved.sums->pixels.size());
    EXPECT_EQ(std::memcmp(back.sums->pixels.data(), saved.sums->pixels.data(), saved.sums->pixels.size() * 4), 0);
}

// Every shorter file, and every file with a changed bit.
TEST(Checkpoint, DamagedFilesAreRefused) {
    const Scratch scratch;
    save_checkpoint(scratch.path("a"), sample_checkpoint());
    const std::string whole = scratch.read("a");
    for (size_t bytes = 0; bytes < whole.size(); ++bytes)
        ASSERT_NE(why_refused(scratch.write("b", whole.substr(0, bytes))), "") << bytes << " bytes";
    ASSERT_NE(why_refused(scratch.write("b", whole + "x")), "");
    for (size_t bit = 0; bit < whole.size() * 8; bit += 3) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        ASSERT_NE(why_refused(scratch.write("b", damaged)), "") << "bit " << bit;
    }
    EXPECT_NE(why_refused(scratch.path("missing")).find("No such file"), std::string::npos);
    EXPECT_NE(why_refused(scratch.path("")), "") << "a folder";
}

// A head that promises more than the file holds takes no memory.
TEST(Checkpoint, AHugePictureIsRefusedBeforeItTakesMemory) {
    const Scratch scratch;
    std::string head = R"({"picture": "", "way": "", "width": 4000000000, "height": 4000000000, "samples": 1, "of": 2})";
    std::string file = "ClCheck1" + std::string(1, static_cast<char>(head.size())) + std::string(7, '\0') + head;
    EXPECT_NE(why_refused(scratch.write("a", file + std::string(64, '0'))).find("its size"), std::string::npos);
}
