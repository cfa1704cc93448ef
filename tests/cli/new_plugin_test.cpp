// new_plugin_test.cpp -- `clarity new-plugin`: what it makes, and what it refuses without a trace. tests/sdk builds what it
// makes.
#include <gtest/gtest.h>
#include <unistd.h>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;

namespace {

class NewPlugin : public ::testing::Test {
 protected:
    ProgramResult make(const std::string& kind, const std::string& id, const std::string& folder) {
        return run_program({"new-plugin", kind, id, scratch_.path(folder)});
    }
    size_t entries(const std::string& folder) const {
        return size_t(std::distance(fs::directory_iterator(scratch_.path(folder)), fs::directory_iterator()));
    }
    Scratch scratch_;
};

}  // namespace

TEST_F(NewPlugin, RenamesFilesAndWordsInThem) {
    const ProgramResult result = make("accel", "tree7", "a folder");
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("clarity"), std::string::npos) << result.out;
    for (const char* file : {"CMakeLists.txt", "README.md", "try.scene", "tree7.cpp", "tree7.cl", "tree7_types.h"})
        EXPECT_TRUE(fs::exists(scratch_.path(std::string("a folder/") + file))) << file;
    for (const auto& entry : fs::directory_iterator(scratch_.path("a folder"))) {
        const std::string text = scratch_.read("a folder/" + entry.path().filename().string());
        EXPECT_EQ(text.find("my_accel"), std::string::npos) << entry.path();
        EXPECT_EQ(text.find("MY_ACCEL"), std::string::npos) << entry.path();
    }
    EXPECT_NE(scratch_.read("a folder/tree7_types.h").find("#ifndef TREE7_TYPES_H"), std::string::npos);
    EXPECT_NE(scratch_.read("a folder/README.md").find("./build/tree7.so"), std::string::npos);
    ASSERT_EQ(make("importer", "stone", "stone").exit_code, 0);
    EXPECT_TRUE(fs::exists(scratch_.path("stone/stone.cpp")));
    ASSERT_EQ(make("primitive", "pebble", "pebble").exit_code, 0);
    for (const char* file : {"CMakeLists.txt", "README.md", "try.scene", "pebble.cpp", "pebble.cl"}) {
        const std::string text = scratch_.read(std::string("pebble/") + file);
        EXPECT_NE(text.find("pebble"), std::string::npos) << file;
        EXPECT_EQ(text.find("my_primitive"), std::string::npos) << file;
    }
    ASSERT_EQ(make("surface", "moss", "moss").exit_code, 0);
    EXPECT_NE(scratch_.read("moss/moss.cl").find("rt_surface_draw moss_sample"), std::string::npos);
    EXPECT_EQ(entries("."), 4u) << "nothing else is left";
}

TEST_F(NewPlugin, NeverOverwrites) {
    const std::string kept = scratch_.write("taken/mine.txt", "mine");
    const ProgramResult result = make("accel", "tree", "taken");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("is not empty"), std::string::npos) << result.err;
    EXPECT_EQ(entries("taken"), 1u);
    EXPECT_EQ(scratch_.read("taken/mine.txt"), "mine");
    EXPECT_EQ(make("accel", "tree", "taken/mine.txt").exit_code, 1);
    EXPECT_EQ(scratch_.read("taken/mine.txt"), "mine");
    EXPECT_EQ(entries("."), 1u);
    // A folder that is empty is filled, with nothing besides.
    fs::create_directories(scratch_.path("empty"));
    EXPECT_EQ(make("accel", "tree", "empty").exit_code, 0);
    EXPECT_EQ(entries("empty"), 6u);
}

TEST_F(NewPlugin, SaysWhatIsWrong) {
    for (const char* id :
         {"Tree", "7tree", "my-tree", "", "../x", "a b", "rt_tree", "rt", "a_name_that_is_longer_than_any_id_may_be"}) {
        const ProgramResult result = make("accel", id, "x");
        EXPECT_EQ(result.exit_code, 2) << id;
        EXPECT_NE(result.err.find("id"), std::string::npos) << result.err;
    }
    for (const char* kind : {"acel", "..", "."}) {
        const ProgramResult result = make(kind, "tree", "x");
        EXPECT_EQ(result.exit_code, 2) << kind;
        EXPECT_NE(result.err.find("accel, importer, primitive, surface"), std::string::npos) << result.err;
    }
    const ProgramResult nowhere = make("accel", "tree", "no/where");
    EXPECT_EQ(nowhere.exit_code, 1);
    EXPECT_NE(nowhere.err.find(scratch_.path("no") + " is not there"), std::string::npos) << nowhere.err;
    EXPECT_EQ(entries("."), 0u);
}

TEST_F(NewPlugin, ATakenIdIsAWarning) {
    const ProgramResult result = make("accel", "linear", "x");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.err.find("'linear' is taken by"), std::string::npos) << result.err;
}

TEST_F(NewPlugin, AFolderThatCannotBeWrittenStaysAsItIs) {
    if (getuid() == 0) GTEST_SKIP() << "root may write everywhere";
    fs::create_directories(scratch_.path("locked"));
    fs::permissions(scratch_.path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    const ProgramResult result = make("accel", "tree", "locked/x");
    fs::permissions(scratch_.path("locked"), fs::perms::owner_all);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("nothing can be written there"), std::string::npos) << result.err;
    EXPECT_EQ(entries("locked"), 0u);
}
