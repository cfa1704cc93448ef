// kernel_text_test.cpp -- which text a kernel is compiled from, and how a compiler's log is read.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "base/error.hpp"
#include "base/log.hpp"
#include "device/kernel_files.hpp"
#include "device/kernel_includes.hpp"
#include "device/program.hpp"
#include "rt_plugin.hpp"
#include "support/scratch.hpp"

using namespace clarity;
namespace fs = std::filesystem;

namespace {

// A plugin that is this test program. Files beside its library are then files beside the test.
constexpr rt_slot kSlots[] = {rt::slot<rt_u32>("nodes", "uint")};
constexpr rt_accel kAccel =
    rt::accel(kSlots, {"watched_types.h", "compiled types\n"}, {"watched.cl", "compiled"}, nullptr, nullptr, rt::Traits());
constexpr rt_plugin kPlugin = rt::accel_plugin("watched", "Watched", "1", nullptr, kAccel);

class KernelText : public ::testing::Test {
 protected:
    void SetUp() override { environment_.set("CLARITY_KERNEL_PATH", "embedded"); }
    void from_disk() {
        fs::create_directories(scratch_.path("cl"));
        environment_.set("CLARITY_KERNEL_PATH", scratch_.path("cl"));
    }
    static std::string why(const std::function<void()>& read) {
        try {
            read();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::kernel_build_failed);
            return error.what();
        }
        return "nothing was thrown";
    }
    Scratch scratch_;
    Environment environment_;
};

TEST_F(KernelText, FilesOnDiskComeBeforeEmbeddedText) {
    const std::string embedded = kernel_text("tracers/camera.h");
    EXPECT_EQ(kernel_path("cl/tracers/camera.h"), "");
    from_disk();
    EXPECT_EQ(kernel_text("tracers/camera.h"), embedded) << "a file that is not there";
    const std::string path = scratch_.write("cl/tracers/camera.h", "mine");
    EXPECT_EQ(kernel_text("tracers/camera.h"), "mine");
    EXPECT_EQ(kernel_path("cl/tracers/camera.h"), path);
    environment_.set("CLARITY_KERNEL_PATH", scratch_.path("cl") + "/");
    const std::string traversal = scratch_.write("plugins/accel/watched/watched.cl", "mine too");
    EXPECT_EQ(plugin_kernel_text(kPlugin, kAccel.traverse), "mine too");
    EXPECT_EQ(kernel_path("plugins/accel/watched/watched.cl"), traversal);
    environment_.set("CLARITY_KERNEL_PATH", "embedded");
    EXPECT_EQ(kernel_text("tracers/camera.h"), embedded);
    EXPECT_EQ(plugin_kernel_text(kPlugin, kAccel.traverse), "compiled");
}

TEST_F(KernelText, RevisionGrowsWhenTheTextChanges) {
    from_disk();
    scratch_.write("cl/tracers/camera.h", "one");
    kernel_text("tracers/camera.h");
    const uint64_t before = kernel_text_revision();
    kernel_text("tracers/camera.h");
    EXPECT_EQ(kernel_text_revision(), before);
    scratch_.write("cl/tracers/camera.h", "two");
    kernel_text("tracers/camera.h");
    EXPECT_EQ(kernel_text_revision(), before + 1);
}

TEST_F(KernelText, StructsThatDifferFromTheCompiledOnesAreRefused) {
    const std::string types = kernel_text("rt_types.h");
    from_disk();
    scratch_.write("cl/rt_types.h", types);
    EXPECT_EQ(kernel_text("rt_types.h"), types);
    scratch_.write("cl/rt_types.h", "\n" + types);
    std::string said = why([] { kernel_text("rt_types.h"); });
    EXPECT_NE(said.find(scratch_.path("cl/rt_types.h:1:")), std::string::npos) << said;
    EXPECT_NE(said.find("build the program again"), std::string::npos) << said;
    scratch_.write("plugins/accel/watched/watched_types.h", "compiled types\n");
    EXPECT_EQ(plugin_kernel_text(kPlugin, kAccel.types), "compiled types\n");
    scratch_.write("plugins/accel/watched/watched_types.h", "compiled types\nand more");
    said = why([] { plugin_kernel_text(kPlugin, kAccel.types); });
    EXPECT_NE(said.find("watched_types.h:2:"), std::string::npos) << said;
    EXPECT_NE(said.find("build the plugin again"), std::string::npos) << said;
}

TEST_F(KernelText, AMissingFolderIsAnError) {
    environment_.set("CLARITY_KERNEL_PATH", scratch_.path("nowhere"));
    const std::string said = why([] { kernel_text("tracers/camera.h"); });
    EXPECT_NE(said.find(scratch_.path("nowhere")), std::string::npos) << said;
}

TEST_F(KernelText, CandidatesAreAllFilesThatMayBeUsed) {
    EXPECT_TRUE(kernel_candidates({&kPlugin}).empty());
    from_disk();
    const std::vector<std::string> all = kernel_candidates({&kPlugin});
    for (const char* name : {"cl/rt_types.h", "cl/film.cl", "cl/tracers/iterative/iterative.cl",
                             "plugins/accel/watched/watched.cl", "plugins/accel/watched/watched_types.h"})
        EXPECT_EQ(std::count(all.begin(), all.end(), scratch_.path(name)), 1) << name;
}

TEST_F(KernelText, PartsOfAPluginAreInserted) {
    from_disk();
    scratch_.write("plugins/accel/watched/watched.cl", "one\n#include \"watched_part.cl\"\nthree\n");
    const std::string part = scratch_.write("plugins/accel/watched/watched_part.cl", "two");
    EXPECT_EQ(
        plugin_kernel_text(kPlugin, kAccel.traverse),
        "one\n#line 1 \"plugins/accel/watched/watched_part.cl\"\ntwo\n#line 3 \"plugins/accel/watched/watched.cl\"\nthree\n");
    EXPECT_EQ(kernel_path("plugins/accel/watched/watched_part.cl"), part);
    const std::vector<std::string> all = kernel_candidates({&kPlugin});
    EXPECT_EQ(std::count(all.begin(), all.end(), part), 1) << "a part is watched";
    const uint64_t before = kernel_text_revision();
    scratch_.write("plugins/accel/watched/watched_part.cl", "another two");
    plugin_kernel_text(kPlugin, kAccel.traverse);
    EXPECT_EQ(kernel_text_revision(), before + 1);
}

TEST_F(KernelText, APluginIncludesFilesOfCl) {
    from_disk();
    scratch_.write("cl/lanes/mine.h", "mine\n");
    scratch_.write("plugins/accel/watched/watched.cl", "#include \"cl/lanes/mine.h\"\n");
    EXPECT_EQ(plugin_kernel_text(kPlugin, kAccel.traverse),
              "#line 1 \"cl/lanes/mine.h\"\nmine\n#line 2 \"plugins/accel/watched/watched.cl\"\n");
    EXPECT_EQ(kernel_path("cl/lanes/mine.h"), scratch_.path("cl/lanes/mine.h"));
}

TEST_F(KernelText, IncludesThatCannotBeFollowedAreSaid) {
    from_disk();
    const auto refused = [&](const std::string& text) {
        scratch_.write("plugins/accel/watched/watched.cl", text);
        return why([] { plugin_kernel_text(kPlugin, kAccel.traverse); });
    };
    std::string said = refused("#include \"watched_nothing.cl\"\n");
    EXPECT_NE(said.find("watched_nothing.cl"), std::string::npos) << said;
    said = refused("\n#include \"../other/other.cl\"\n");
    EXPECT_NE(said.find("plugins/accel/watched/watched.cl:2"), std::string::npos) << said;
    EXPECT_NE(said.find("../other/other.cl"), std::string::npos) << said;
    said = refused("#include \"watched.cl\"\n");
    EXPECT_NE(said.find("in a circle"), std::string::npos) << said;
}

// Files beside the library of a plugin outside of a checkout, which is this test program.
class BesideLibrary : public KernelText {
 protected:
    void SetUp() override {
        environment_.set("CLARITY_KERNEL_PATH", "");
        set_log_listener([this](LogLevel level, const std::string& line) {
            (level == LogLevel::warning ? warnings_ : notes_).push_back(line);
        });
    }
    void TearDown() override {
        set_log_listener({});
        fs::remove(note_);
        fs::remove(beside_);
    }
    static void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
    static bool says(const std::vector<std::string>& lines, const std::string& part) {
        return std::any_of(lines.begin(), lines.end(), [&](const auto& line) { return line.find(part) != std::string::npos; });
    }
    static std::string text() { return plugin_kernel_text(kPlugin, kAccel.traverse); }
    const fs::path library_ = fs::read_symlink("/proc/self/exe");
    const fs::path note_ = fs::path(library_).replace_extension(".sources"), beside_ = library_.parent_path() / "watched.cl";
    std::vector<std::string> warnings_, notes_;
};

TEST_F(BesideLibrary, ItsSourcesComeFirstAndAreWatched) {
    EXPECT_EQ(text(), "compiled");
    EXPECT_EQ(kernel_place("plugins/accel/watched/watched.cl"), "watched.cl inside " + library_.string());
    const std::string source = scratch_.write("sources/watched.cl", "edited");
    write(note_, scratch_.path("sources") + "\n");
    EXPECT_EQ(text(), "edited");
    EXPECT_EQ(kernel_place("plugins/accel/watched/watched.cl"), source);
    EXPECT_TRUE(says(notes_, source + ": is used; it differs from the text built into " + library_.string()));
    EXPECT_EQ(std::count(notes_.begin(), notes_.end(), notes_.back()), 1);
    text();
    EXPECT_EQ(std::count(notes_.begin(), notes_.end(), notes_.back()), 1) << "said once for each text";
    const std::vector<std::string> watched = kernel_candidates({&kPlugin});
    EXPECT_EQ(std::count(watched.begin(), watched.end(), source), 1);
    EXPECT_EQ(std::count(watched.begin(), watched.end(), beside_.string()), 1);

    write(beside_, "copy");
    EXPECT_EQ(text(), "edited");
    EXPECT_TRUE(says(warnings_, beside_.string() + ": is not used, because " + source + " comes first"));
    fs::remove(source);
    EXPECT_EQ(text(), "copy");
}

TEST_F(BesideLibrary, AnOldCopyIsReportedAndNotUsed) {
    write(beside_, "old copy");
    const auto built = fs::last_write_time(library_);
    fs::last_write_time(beside_, built - std::chrono::hours(1));
    EXPECT_EQ(text(), "compiled");
    EXPECT_TRUE(says(warnings_, beside_.string() + ": is not used, because it is older than " + library_.string()));
    fs::last_write_time(beside_, built + std::chrono::hours(1));
    EXPECT_EQ(text(), "old copy");
    EXPECT_TRUE(says(notes_, beside_.string() + ": is used; it differs"));
    // An equal copy is no news, however old.
    notes_.clear(), warnings_.clear();
    write(beside_, "compiled");
    fs::last_write_time(beside_, built - std::chrono::hours(1));
    EXPECT_EQ(text(), "compiled");
    EXPECT_EQ(kernel_place("plugins/accel/watched/watched.cl"), beside_.string());
    EXPECT_TRUE(notes_.empty() && warnings_.empty());
}

TEST(KernelIncludes, OnlyWholeLinesCount) {
    const auto read = [](const std::string& name) { return "<" + name + ">\n"; };
    const std::string text =
        "  #include \"a.h\"\n#include <a.h>\n#include \"a.h\" x\n// #include \"a.h\"\n#include \"cl/a.h\"\n";
    EXPECT_EQ(expand_includes(text, "f/b.cl", IncludeKind::part, read), text);
    EXPECT_EQ(included_parts("#include \"a.h\"\n" + text + "#include \"b.h\"").size(), 2u);
    EXPECT_EQ(expand_includes("#include \"a.h\"", "f/b.cl", IncludeKind::part, read),
              "#line 1 \"f/a.h\"\n<a.h>\n#line 2 \"f/b.cl\"\n");
}

TEST_F(KernelText, CandidatesIncludeFilesBesideAPluginsLibrary) {
    environment_.set("CLARITY_KERNEL_PATH", "");
    const std::vector<std::string> all = kernel_candidates({&kPlugin});
    const std::string beside = (fs::read_symlink("/proc/self/exe").parent_path() / "watched.cl").string();
    EXPECT_EQ(std::count(all.begin(), all.end(), beside), 1) << beside;
}

TEST(CompilerMessages, AreReadFromPoclAndClang) {
    const CompilerLog pocl = read_compiler_log(
        "error: cl/a.cl:42:7: unknown type name 'this'\nwarning: cl/a.cl:1:2: odd\n"
        "2 errors generated.\nDevice some CPU failed to build the program\n");
    EXPECT_EQ(pocl.first.file, "cl/a.cl");
    EXPECT_EQ(pocl.first.line, 42u);
    EXPECT_EQ(pocl.first.column, 7u);
    EXPECT_EQ(pocl.first.message, "unknown type name 'this'");
    EXPECT_EQ(pocl.errors, 1u);
    EXPECT_EQ(pocl.text, "cl/a.cl:42:7: error: unknown type name 'this'\ncl/a.cl:1:2: warning: odd");

    const CompilerLog four_times = read_compiler_log(
        "cl/a.cl:7:1: error: no\n    x;\n    ^\ncl/a.cl:9:1: error: no\ncl/a.cl:7:1: error: no\n    x;\n    ^\n4 errors "
        "generated.\n");
    EXPECT_EQ(four_times.errors, 2u);
    EXPECT_EQ(four_times.text, "cl/a.cl:7:1: error: no\n    x;\n    ^\ncl/a.cl:9:1: error: no");

    const CompilerLog clang = read_compiler_log(
        "cl/b.h:3:9: warning: unused: x\ncl/b.h:4:1: fatal error: no such: thing\n    x;\n"
        "    ^\n1 warning and 1 error generated.\n");
    EXPECT_EQ(clang.first.file, "cl/b.h");
    EXPECT_EQ(clang.first.line, 4u);
    EXPECT_EQ(clang.first.message, "no such: thing");
    EXPECT_EQ(clang.text, "cl/b.h:3:9: warning: unused: x\ncl/b.h:4:1: fatal error: no such: thing\n    x;\n    ^");
}

TEST(CompilerMessages, MayLackPlaceOrReason) {
    const CompilerLog bare = read_compiler_log("error: Invalid build option: -x\r\n");
    EXPECT_EQ(bare.first.file, "");
    EXPECT_EQ(bare.first.message, "Invalid build option: -x");
    EXPECT_EQ(read_compiler_log("ptxas fatal: unresolved\n").first.message, "ptxas fatal: unresolved");
    EXPECT_FALSE(read_compiler_log("").first.message.empty());
    EXPECT_EQ(read_compiler_log(std::string(1 << 20, ':')).errors, 0u);
    EXPECT_EQ(read_compiler_log("cl/a.cl:99999999999:1: error: far\n").first.line, 0u);
}

}  // namespace
