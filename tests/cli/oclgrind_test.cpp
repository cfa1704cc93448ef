// oclgrind_test.cpp -- runs the kernels under oclgrind, which simulates a device and checks every memory access: nothing out of
// bounds, no races.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;

namespace {

class Oclgrind : public ::testing::Test {
 protected:
    void SetUp() override {
        if (std::system("oclgrind --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "oclgrind is not installed";
        scratch_.write("cube.obj",
                       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                       "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
        // Every kind of primitive, instances, and every kind of ray.
        scene_ = scratch_.write("a.scene",
                                "camera main eye 1 3 8 target 0 1 0 fov 40\n"
                                "light point position 3 6 4\n"
                                "light directional direction -1 -2 -1\n"
                                "material mirror color .2 reflect .8\n"
                                "material glass color .9 refract .95 ior 1.5\n"
                                "plane normal 0 1 0 offset 0\n"
                                "sphere center -1 1 2 radius .7 material glass\n"
                                "polygon material mirror vertices -3 0 -3  3 0 -3  3 3 -3  0 1.5 -3  -3 3 -3\n"
                                "load cube.obj\n"
                                "load cube.obj translate 1.5 0 1 rotate 0 1 0 30\n"
                                "load cube.obj translate -2.5 0 0 scale 1.4 material glass\n");
    }
    // Renders one small frame and returns oclgrind's messages.
    std::string report(std::vector<std::string> words, const std::string& kernels = {}) {
        const std::string log = scratch_.path("log"), picture = scratch_.path("a.png");
        RunOptions options;
        options.wrapper = {"oclgrind", "--data-races", "--check-api", "--log", log};
        options.limit_s = 300;
        if (!kernels.empty()) options.environment = {{"CLARITY_KERNEL_PATH", kernels}};
        words.insert(words.begin(), {"render", scene_, "-o", picture, "--size", "32x24", "--depth", "4"});
        const ProgramResult result = run_program(words, options);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_TRUE(fs::exists(picture)) << result.err;
        return scratch_.read("log");
    }

    Scratch scratch_;
    std::string scene_;
};

}  // namespace

TEST_F(Oclgrind, EveryStructureIsClean) {
    const nlohmann::json plugins = nlohmann::json::parse(run_program({"plugins", "--json"}).out)["plugins"];
    int count = 0;
    for (const auto& plugin : plugins) {
        if (plugin["status"] != "loaded" || plugin["kind"] != "accel") continue;
        const std::string id = plugin["id"];
        EXPECT_EQ(report({"--accel", id, "--lanes", "4"}).substr(0, 2000), "") << id;
        EXPECT_EQ(report({"--accel", id, "--lanes", "1", "--debug", "true"}).substr(0, 2000), "") << id;
        EXPECT_EQ(report({"--accel", id, "--lanes", "1", "--portable", "true", "--tracer", "wavefront"}).substr(0, 2000), "")
            << id;
        ++count;
    }
    EXPECT_GE(count, 3);
    EXPECT_EQ(report({"--accel", "bvh2", "--lanes", "4", "--tracer", "wavefront"}).substr(0, 2000), "");
}

TEST_F(Oclgrind, ReportsAnErrorMadeOnPurpose) {
    fs::copy(fs::path(CLARITY_SOURCE_DIR) / "cl", scratch_.path("cl"), fs::copy_options::recursive);
    std::string film = scratch_.read("cl/film.cl");
    const std::string store = "alpha, i, display)";
    const size_t at = film.find(store);
    ASSERT_NE(at, std::string::npos) << "film.cl has changed: this test needs a store to break";
    film.replace(at, store.size(), "alpha, i + (1u << 20), display)");
    scratch_.write("cl/film.cl", film);
    EXPECT_NE(report({}, scratch_.path("cl")).find("Invalid write"), std::string::npos);
}
