// lab_command_test.cpp -- what `clarity lab` does besides marking: handouts, copies, nights, the page of marks, refusals.
#include <gtest/gtest.h>

#include <seccomp.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "base/files/process_folder.hpp"
#include "cli/run_program.hpp"
#include "lab_sdk.hpp"
#include "support/scratch.hpp"
#include "tools/lab/build.hpp"
#include "tools/lab/grade.hpp"
#include "tools/lab/results.hpp"
#include "worker/child.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A shared file that is nowhere, and a name that leads elsewhere, are refused.
TEST(Lab, SharedFilesComeWithTheHandoutAndWithACopy) {
    const Scratch scratch;
    const auto has = [&](const std::string& file) { return fs::exists(scratch.path(file)); };
    clarity::lab::copy_lab(kLabs + "/binned", scratch.path("copy"));
    EXPECT_TRUE(has("copy/handout/lab_tree.hpp"));
    clarity::lab::write_handout(clarity::lab::read_lab(scratch.path("copy"), true), scratch.path("mine"), {});
    for (const char* file : {"mine/lab_tree.hpp", "mine/binned.cpp", "mine/page.md", "mine/lab.json", "mine/CMakeLists.txt"})
        EXPECT_TRUE(has(file)) << file;
    EXPECT_FALSE(has("mine/reference") || has("mine/hidden"));
    fs::remove(scratch.path("copy/handout/lab_tree.hpp"));
    EXPECT_THROW(clarity::lab::read_lab(scratch.path("copy"), true).given(), clarity::Error);
    json lab = json::parse(scratch.read("copy/lab.json"));
    lab["shared"] = {"../lab.json"};
    scratch.write("copy/lab.json", lab.dump());
    EXPECT_THROW(clarity::lab::read_lab(scratch.path("copy"), true), clarity::Error);
}

TEST(Lab, OfSurfacesHasNoPointsOfSpeed) {
    const Scratch scratch;
    json lab = json::parse(std::ifstream(kLabs + "/microfacet/lab.json"));
    const auto read = [&] {
        scratch.write("lab/lab.json", lab.dump());
        return clarity::lab::read_lab(scratch.path("lab"), false);
    };
    lab.erase("points");
    EXPECT_EQ(read().points_speed, 0);
    EXPECT_EQ(read().points_counts, 50);
    lab["points"] = {{"speed", 15}};
    EXPECT_THROW(read(), clarity::Error) << "all would get them, because no times are taken";
}

TEST(Lab, LinksAndLargeFilesAreRefused) {
    const Scratch scratch;
    const clarity::lab::Lab lab = clarity::lab::read_lab(kLabs + "/median", true);
    scratch.write("large/median.cpp", std::string(70000, ' '));
    fs::create_directories(scratch.path("link"));
    fs::create_symlink(kLabs + "/median/hidden/cases.json", scratch.path("link/median.cpp"));
    fs::create_directories(scratch.path("none"));
    for (const char* name : {"large", "link", "none"})
        EXPECT_THROW(clarity::lab::collect(lab, scratch.path(name), scratch.path("to")), clarity::lab::Refused) << name;
}

TEST(Lab, ForbiddenWordsAreNamedWithTheirLine) {
    using clarity::lab::forbidden_word;
    EXPECT_EQ(forbidden_word("int a;\nint b = rt_bits(c);", {"rt_"}), "line 2 has `rt_`");
    EXPECT_EQ(forbidden_word("int start_rt;", {"rt_"}), "");
    EXPECT_EQ(forbidden_word("int hits;", {"hit"}), "");
    EXPECT_EQ(forbidden_word("/* hit */ int a; // hit\n", {"hit"}), "");
    EXPECT_EQ(forbidden_word("/* */ hit /* */", {"hit"}), "line 1 has `hit`");
    EXPECT_EQ(forbidden_word("a \\\n b", {"\\"}), "line 1 has `\\`");
}

TEST(Lab, PointsOfCountsAreOnALogScale) {
    clarity::lab::Lab lab;
    lab.full = 1, lab.none = 4;
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 0.5), 1);
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 2), 0.5);
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 5), 0);
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 0), 0);
}

// What students get has no reference, but its figures; they see the public lines of the grader, and each says how to see it
// alone.
TEST(Lab, AHandoutIsCheckedByTheGradersCode) {
    install_sdk();
    const Scratch scratch;
    const std::string folder = scratch.path("mine"), work = std::string(CLARITY_BUILD_DIR) + "/tests/tools/lab/work_handout";
    const ProgramResult made = run_program({"lab", "handout", kLabs + "/median", folder, "--sdk", kSdk, "--work", work});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_FALSE(fs::exists(folder + "/hidden")) << "students have the hidden cases";
    EXPECT_FALSE(fs::exists(folder + "/reference"));
    const ProgramResult starter = run_program({"lab", "check", folder, "--sdk", kSdk, "--work", work, "--only", "city"});
    EXPECT_EQ(starter.exit_code, 1);
    EXPECT_NE(starter.out.find("the builder is not written yet"), std::string::npos) << starter.out;
    EXPECT_NE(starter.out.find("alone: clarity lab check . --only city"), std::string::npos) << starter.out;
    fs::copy(kLabs + "/median/reference/median.cpp", folder + "/median.cpp", fs::copy_options::overwrite_existing);
    const ProgramResult solved = run_program({"lab", "check", folder, "--sdk", kSdk, "--work", work, "--only", "city"});
    EXPECT_EQ(solved.exit_code, 0) << solved.out << solved.err;
    EXPECT_NE(solved.out.find("1.00 times the work of the reference"), std::string::npos) << solved.out;
}

// They would mark each other's libraries.
TEST(Lab, TwoGradersDoNotShareAFolder) {
    install_sdk();
    const Scratch scratch;
    fs::create_directories(scratch.path("work"));
    const std::vector<std::string> words = {"lab", "check", kLabs + "/median", "--sdk", kSdk, "--work", scratch.path("work")};
    auto other = clarity::FolderLock::take(scratch.path("work"));
    ASSERT_TRUE(other);
    EXPECT_FALSE(clarity::FolderLock::take(scratch.path("work")));
    const ProgramResult refused = run_program(words);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.err.find(scratch.path("work") + ": another `clarity lab` builds there; wait for its end"),
              std::string::npos)
        << refused.err;
    EXPECT_FALSE(fs::exists(scratch.path("work/tools"))) << "something was built";
    other.reset();
    EXPECT_TRUE(clarity::FolderLock::take(scratch.path("work")));
}

// Two processes share a night. One is killed in it; when the other has come to its end, no record is missing and none was made
// twice.
TEST(Lab, ANightIsSharedAndSurvives) {
    install_sdk();
    const Scratch scratch;
    std::vector<std::string> words = {"lab", "night", kLabs + "/median"};
    for (const char* name : {"a", "b", "c"}) {
        fs::create_directories(scratch.path(name));
        fs::copy(kLabs + "/median/handout/median.cpp", scratch.path(std::string(name) + "/median.cpp"));
        words.push_back(scratch.path(name));
    }
    words.insert(words.end(), {"-o", scratch.path("marks"), "--sdk", kSdk, "--counts-only"});
    RunOptions killed;
    killed.signal = SIGKILL;
    killed.signal_when_made = scratch.path("marks/a.json");
    ProgramResult first, second;
    std::thread other([&] { first = run_program(words, killed); });
    second = run_program(words);
    other.join();
    ProgramResult last = second;
    for (int tries = 0; last.exit_code != 0 && tries < 100; ++tries) last = run_program(words);
    EXPECT_EQ(last.exit_code, 0) << last.err;
    for (const char* name : {"a", "b", "c"}) {
        EXPECT_TRUE(json::parse(scratch.read(std::string("marks/") + name + ".json"), nullptr, false).is_object()) << name;
        const std::string line = std::string(name) + "  0.0\n";
        const size_t at = second.out.find(line);
        EXPECT_TRUE(at == std::string::npos || first.out.find(line) == std::string::npos) << name << " was graded twice";
    }
    const ProgramResult again = run_program(words);
    EXPECT_EQ(again.out, "") << "what has a record is graded again";
    scratch.write("a/median.cpp", "another one\n");
    EXPECT_EQ(run_program(words).out, "a  0.0\n") << "what was handed in again is not graded again";
}

TEST(Lab, TheBoardRanksByWork) {
    const Scratch scratch;
    const auto record = [&](const std::string& name, double work, double total) {
        scratch.write(name + ".json", json{{"submission", name}, {"work", work}, {"total", total}}.dump());
    };
    record("slow", 2, 70), record("best", 1, 100), record("alike", 1.015, 99), record("third", 1.03, 98),
        record("<wrong>", 0, 20);
    const auto rows = clarity::lab::read_board(scratch.path(""));
    const std::pair<const char*, unsigned> expected[] = {{"best", 1}, {"alike", 1}, {"third", 3}, {"slow", 4}, {"<wrong>", 0}};
    ASSERT_EQ(rows.size(), 5u);
    for (size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].name, expected[i].first);
        EXPECT_EQ(rows[i].rank, expected[i].second) << rows[i].name;
    }
    const std::string page = clarity::lab::board_html("A lab", rows);
    EXPECT_EQ(page.find("<wrong>"), std::string::npos);
    EXPECT_NE(page.find("&lt;wrong&gt;"), std::string::npos);
    EXPECT_THROW(clarity::lab::read_board(scratch.path("none")), clarity::Error);
}

// Grades a submission that includes the hidden cases, on a system without bubblewrap; without Landlock, too, if `landlock` is
// false. What the program prints goes to the file `to`.
void grade_without_bubblewrap(const Scratch& scratch, bool landlock, const std::string& to) {
    if (!landlock) {
        const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
        if (seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(landlock_create_ruleset), 0) != 0 ||
            seccomp_load(filter) != 0)
            return;
    }
    RunOptions options;
    options.environment["PATH"] = scratch.path("bin") + ":" + std::getenv("PATH");
    const ProgramResult result =
        run_program({"lab", "grade", kLabs + "/median", scratch.path("curious"), "--sdk", kSdk, "--counts-only"}, options);
    scratch.write(to, result.out + result.err);
}

// Each sandbox is said, and none shows what a submission includes of the teacher's. The reference solution is built in it.
TEST(Lab, WithoutBubblewrapAndLandlockCompilersAreStillShutIn) {
    install_sdk();
    const Scratch scratch;
    scratch.write("bin/bwrap", "#!/bin/sh\nexit 1\n");
    fs::permissions(scratch.path("bin/bwrap"), fs::perms::owner_all);
    scratch.write("curious/median.cpp", "#include \"" + kLabs + "/median/hidden/cases.json\"\n");
    for (const bool landlock : {true, false}) {
        // A filter of system calls stays for the rest of a process.
        const pid_t child = fork();
        if (child == 0) {
            grade_without_bubblewrap(scratch, landlock, "said");
            _exit(0);
        }
        waitpid(child, nullptr, 0);
        const std::string said = scratch.read("said");
        const bool by_landlock = landlock && clarity::worker::restricts_files();
        EXPECT_NE(said.find(by_landlock ? "sandbox: a worker's limits (Landlock" : "sandbox: resource limits alone"),
                  std::string::npos)
            << said;
        EXPECT_NE(said.find("it does not compile"), std::string::npos) << said;
        EXPECT_NE(said.find("0.0 of 100.0 points"), std::string::npos) << said;
        EXPECT_EQ(said.find("the reference solution"), std::string::npos) << said;
        for (const char* secret : {"7301", "hidden-1", "teapots"}) EXPECT_EQ(said.find(secret), std::string::npos) << said;
        fs::remove(scratch.path("said"));
    }
}

// A machine whose CMake is in a Python environment: what PATH has is a script, the program is further away, and nothing of
// either is in a folder of the system's.
void move_cmake(const Scratch& scratch) {
    const std::string program = scratch.path("env/lib/cmake/bin"), root = scratch.path("env/lib/cmake/share");
    const std::string ask = scratch.write("ask.cmake", "message(\"${CMAKE_COMMAND}\\n${CMAKE_ROOT}\")\n");
    const std::string copy = "cmake -P '" + ask + "' 2>'" + ask + ".out' && { read c; read r; } <'" + ask +
                             ".out' && mkdir -p '" + program + "' '" + root + "' && cp \"$c\" '" + program +
                             "/cmake' && cp -r \"$r\" '" + root + "'";
    ASSERT_EQ(std::system(copy.c_str()), 0) << copy;
    scratch.write("env/bin/cmake", "#!/bin/sh\nexec '" + program + "/cmake' \"$@\"\n");
    fs::permissions(scratch.path("env/bin/cmake"), fs::perms::owner_all);
    fs::create_directories(scratch.path("links"));
    for (const std::string name : {"bwrap", "cc", "c++", "make", "as", "ld", "ar", "ranlib", "sh", "true"})
        for (const char* folder : {"/usr/local/bin/", "/usr/bin/", "/bin/"})
            if (fs::exists(folder + name) && !fs::is_symlink(fs::symlink_status(scratch.path("links/" + name))))
                fs::create_symlink(fs::canonical(folder + name), scratch.path("links/" + name));
}

TEST(Lab, ToolsAreFoundWhereverTheyAre) {
    install_sdk();
    const Scratch scratch;
    move_cmake(scratch);
    const std::string path = scratch.path("env/bin") + ":" + scratch.path("links");
    const auto graded = [&](const std::string& first, const std::vector<std::string>& more = {}) {
        RunOptions options;
        options.environment["PATH"] = (first.empty() ? "" : scratch.path(first) + ":") + path;
        std::vector<std::string> words = {"lab", "grade", kLabs + "/median", scratch.path("nothing"), "--sdk", kSdk};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_program(words, options);
        return result.out + result.err;
    };
    // Nothing was handed in, and this is told behind the build of the reference solution.
    const std::string built = "median.cpp is not there";
    const auto program = [&](const std::string& name, const std::string& text) {
        fs::permissions(scratch.write(name, "#!/bin/sh\n" + text + "\n"), fs::perms::owner_all);
    };
    program("without/bwrap", "exit 1");
    for (const char* first : {"", "without"}) EXPECT_NE(graded(first).find(built), std::string::npos) << graded(first);
    // A compiler that runs a program of a folder of which it says nothing.
    program("else/compiler", "exec " + fs::canonical(scratch.path("links/c++")).string() + " \"$@\"");
    program("odd/c++", "test \"$1\" = -E -o \"$1\" = -print-search-dirs || exec " + scratch.path("else/compiler") + " \"$@\"");
    const std::string said = graded("odd");
    EXPECT_NE(said.find("does not run in the sandbox: `" + scratch.path("odd/c++") + " try.cpp` failed"), std::string::npos)
        << said;
    EXPECT_NE(said.find("name others that it needs by --tools"), std::string::npos) << said;
    const std::string named = graded("odd", {"--tools", scratch.path("else")});
    EXPECT_NE(named.find(built), std::string::npos) << named;
}

// A folder that is opened for a tool holds neither the home nor anything that is closed.
TEST(Lab, ToolsOpenNoHomeAndNoSubmission) {
    const Scratch scratch;
    move_cmake(scratch);
    scratch.write("env/lib/cmake/lib/notes.txt", "of the home");
    scratch.write("more/submission/a.cpp", ""), scratch.write("more/headers/a.h", "");
    Environment environment;
    environment.set("PATH", scratch.path("env/bin") + ":" + scratch.path("links"));
    const auto opens = [&](const std::string& name, const std::string& more = {}) {
        const std::vector<std::string> named = more.empty() ? std::vector<std::string>() : std::vector{scratch.path(more)};
        const auto tools = clarity::lab::find_build_tools(kSdk, named, {scratch.path("more/submission")}, scratch.path(""));
        const std::string file = scratch.path(name);
        const auto own = tools.own_folders();
        return std::any_of(own.begin(), own.end(),
                           [&](const std::string& folder) { return file == folder || file.rfind(folder + "/", 0) == 0; });
    };
    EXPECT_TRUE(opens("env/lib/cmake/bin/cmake"));
    EXPECT_TRUE(opens("env/lib/cmake/lib/notes.txt"));
    EXPECT_FALSE(opens("env/lib/notes.txt"));
    EXPECT_TRUE(opens("more/headers/a.h", "more"));
    EXPECT_FALSE(opens("more/submission/a.cpp", "more"));
    EXPECT_THROW(opens("", "none"), clarity::Error);
    environment.set("HOME", scratch.path("env/lib/cmake"));
    EXPECT_TRUE(opens("env/lib/cmake/bin/cmake"));
    EXPECT_FALSE(opens("env/lib/cmake/lib/notes.txt"));
    environment.set("HOME", scratch.path("more/headers"));
    EXPECT_FALSE(opens("more/headers/a.h", "more"));
    environment.set("PATH", scratch.path("links"));
    EXPECT_THROW(opens(""), clarity::Error) << "there is no CMake";
}

// Before grading has come to its end there is a score of 0; a lab that cannot be graded keeps it.
TEST(Lab, ATimeLimitIsNoOtherScore) {
    install_sdk();
    const Scratch scratch;
    fs::copy(kLabs + "/median", scratch.path("lab"), fs::copy_options::recursive);
    scratch.write("lab/reference/median.cpp", "no C++\n");
    const ProgramResult result = run_program({"lab", "grade", scratch.path("lab"), kLabs + "/median/reference", "--sdk", kSdk,
                                              "--gradescope", scratch.path("results.json"), "--autolab"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("the reference solution: it does not compile"), std::string::npos) << result.err;
    EXPECT_EQ(json::parse(scratch.read("results.json"))["score"], 0);
    EXPECT_NE(result.out.find("{\"scores\":{\"checks\":0.0,"), std::string::npos) << result.out;
}

}  // namespace
