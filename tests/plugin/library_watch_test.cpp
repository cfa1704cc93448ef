// Libraries that are built again while the program runs.
#include "plugin/library_watch.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "base/files/library_files.hpp"
#include "support/clock.hpp"
#include "support/scratch.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

const std::string kFolder = std::string(TEST_PLUGINS) + "/";

std::string content(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

class LibraryWatchTest : public testing::Test {
 protected:
    LibraryWatchTest()
        : path_(scratch_.write("sound.so", content(kFolder + "sound.so"))), plugins_(PluginRegistry::of({path_})) {}

    // As a linker: a new file under the same name.
    void build_again(const std::string& from) const {
        fs::remove(path_);
        scratch_.write("sound.so", content(kFolder + from));
    }
    // What apply() gives within `seconds`. A user has to wait two at most.
    std::vector<RebuiltLibrary> applied(double seconds = test::at_most(2)) {
        std::vector<RebuiltLibrary> all;
        test::comes([&] { return !(all = watch_.apply()).empty(); }, seconds);
        return all;
    }
    const rt_plugin* plugin() const { return plugins_.accel("sound"); }

    Scratch scratch_;
    const std::string path_;
    PluginRegistry plugins_;
    std::atomic<int> told_{0};
    LibraryWatch watch_{plugins_, [this] { ++told_; }};
};

TEST_F(LibraryWatchTest, ARebuiltLibraryIsInForceAndTheOldOneStaysLoaded) {
    const rt_plugin* const before = plugin();
    ASSERT_NE(before, nullptr);
    ASSERT_EQ(before->param_count, 1u);
    build_again("sound_again.so");
    const std::vector<RebuiltLibrary> all = applied();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].path, path_);
    EXPECT_EQ(all[0].before, before);
    EXPECT_EQ(all[0].now, plugin());
    EXPECT_GE(told_, 1);
    ASSERT_EQ(plugin()->param_count, 2u);
    EXPECT_STREQ(before->id, "sound") << "still loaded";
    const PluginRecord record = plugins_.records().front();
    EXPECT_EQ(record.path, path_);
    EXPECT_EQ(record.replaced, 1u);
    EXPECT_EQ(load_plugin(record.loaded).plugin, plugin()) << "workers load the same copy";
    EXPECT_EQ(original_of(loaded_file_of(plugin()->id)), path_) << "kernels are looked for beside the library";

    build_again("sound.so");
    ASSERT_EQ(applied().size(), 1u);
    EXPECT_EQ(plugin()->param_count, 1u);
    EXPECT_NE(plugin(), before) << "a library of its own";
    EXPECT_EQ(plugins_.records().front().replaced, 2u);
}

TEST_F(LibraryWatchTest, ARefusedLibraryLeavesTheOldOneInForce) {
    const rt_plugin* const before = plugin();
    for (const char* bad : {"wrong_abi.so", "by_name.so"}) {
        build_again(bad);
        const std::vector<RebuiltLibrary> all = applied();
        ASSERT_EQ(all.size(), 1u) << bad;
        EXPECT_EQ(all[0].now, nullptr);
        EXPECT_NE(all[0].why.find(path_), std::string::npos) << all[0].why;
        EXPECT_NE(all[0].why.find("stays in force"), std::string::npos) << all[0].why;
        EXPECT_EQ(plugin(), before);
        EXPECT_EQ(plugins_.records().front().replaced, 0u);
    }
    EXPECT_TRUE(applied(0.7).empty()) << "said once";
}

TEST_F(LibraryWatchTest, ALibraryThatWasRefusedAtTheStartIsTakenOnceItIsRight) {
    const std::string path = scratch_.write("later.so", content(kFolder + "wrong_abi.so"));
    PluginRegistry plugins = PluginRegistry::of({path});
    ASSERT_EQ(plugins.accel("sound"), nullptr);
    LibraryWatch watch(plugins, [] {});
    scratch_.write("later.so", content(kFolder + "sound.so"));
    EXPECT_TRUE(test::comes([&] {
        watch.apply();
        return plugins.accel("sound") != nullptr;
    }));
}

// A linker may write for a while, and may stop in between.
TEST_F(LibraryWatchTest, AFileThatIsStillWrittenIsNotLoaded) {
    const rt_plugin* const before = plugin();
    const std::string whole = content(kFolder + "sound_again.so");
    fs::remove(path_);
    const int file = open(path_.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0755);
    ASSERT_EQ(write(file, whole.data(), whole.size() / 2), ssize_t(whole.size() / 2));
    EXPECT_TRUE(applied(1).empty());
    EXPECT_EQ(plugin(), before);
    ASSERT_EQ(write(file, whole.data() + whole.size() / 2, whole.size() - whole.size() / 2),
              ssize_t(whole.size() - whole.size() / 2));
    close(file);
    const std::vector<RebuiltLibrary> all = applied();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].why, "");
    EXPECT_NE(plugin(), before);
}

TEST_F(LibraryWatchTest, AFileThatIsWrittenAgainUnchangedIsNoNews) {
    build_again("sound.so");
    EXPECT_TRUE(applied(0.7).empty());
}

TEST_F(LibraryWatchTest, ParametersKeepTheirValuesByKey) {
    const rt_plugin& before = *plugin();
    build_again("sound_again.so");
    ASSERT_EQ(applied().size(), 1u);
    EXPECT_EQ(carried_parameters(before, *plugin(), {6}), (ParameterValues{32, 6}));
    EXPECT_EQ(carried_parameters(before, *plugin(), {16}), (ParameterValues{32, 4})) << "out of the new range";
    EXPECT_EQ(carried_parameters(*plugin(), before, {50, 7}), (ParameterValues{7}));
    EXPECT_EQ(fitting_parameters(*plugin(), {7}), (ParameterValues{7, 4}));
    EXPECT_EQ(fitting_parameters(*plugin(), {99, 2.5}), (ParameterValues{32, 4}));
}

}  // namespace
}  // namespace clarity
