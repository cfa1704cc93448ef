// own_test.cpp -- `clarity check` accuses none of our own plugins.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/quick.hpp"

using clarity::test::quick;

namespace {

using Words = std::vector<std::string>;

// Checks all of our own plugins of a kind. Returns how many there are. Quick tests check plugin `one` with the checks in
// `most`, by kernels of 16 lanes. They check all others with those in `cheap`, which compile no kernels and build small scenes
// only: to compile takes most of the time, and the check of threads takes a minute for `bsp`, because it builds a large scene
// nine times.
int check_own(const std::string& kind, const std::string& one, const Words& most, const Words& cheap) {
    const nlohmann::json plugins = nlohmann::json::parse(run_program({"plugins", "--json"}).out)["plugins"];
    int count = 0;
    for (const auto& plugin : plugins) {
        if (plugin["status"] != "loaded" || plugin["kind"] != kind) continue;
        Words words = {"check", plugin["id"], "--quick"};
        if (quick()) {
            if (plugin["id"] == one) words.insert(words.end(), {"--lanes", "16"});
            for (const std::string& check : plugin["id"] == one ? most : cheap) words.insert(words.end(), {"--only", check});
        }
        RunOptions options;
        options.limit_s = 300;
        const ProgramResult result = run_program(words, options);
        EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
        ++count;
    }
    return count;
}

TEST(Check, AccusesNoneOfOurOwnStructures) {
    EXPECT_GE(
        check_own("accel", "bvh4",
                  {"builds", "hits.kernels", "hits.random", "hits.instances", "hits.primitives", "hits.grazing", "hits.limits"},
                  {"builds.sound", "builds.refs", "builds.bounds", "builds.state", "builds.parameters", "builds.pack",
                   "builds.refit", "builds.afterwards"}),
        3);
}
TEST(Check, AccusesNoneOfOurOwnShapes) {
    EXPECT_GE(check_own("primitive", "torus", {"keys", "hits.kernels", "hits.box", "hits.again", "surface"}, {"keys"}), 6);
}

TEST(Check, SaysWhatIsWrongWithTheWords) {
    const ProgramResult unknown = run_program({"check", "no_such_plugin"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("no plugin of this id"), std::string::npos) << unknown.err;
    const ProgramResult only = run_program({"check", "linear", "--only", "no_such_check"});
    EXPECT_EQ(only.exit_code, 2);
    EXPECT_NE(only.err.find("no check whose name begins"), std::string::npos) << only.err;
    const ProgramResult folder = run_program({"check", "/tmp"});
    EXPECT_EQ(folder.exit_code, 2);
    EXPECT_NE(folder.err.find("is a folder without CMakeLists.txt"), std::string::npos) << folder.err;
}

}  // namespace
