// faults_test.cpp -- `clarity render` with a driver that misbehaves (faulty_icd.c): what the user reads, the exit code, how
// long it takes, and that nothing is left behind.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "cli/run_program.hpp"
#include "support/clock.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = "sphere center 0 0 0 radius 1\nlight point position 2 3 4\n";

class Faults : public ::testing::Test {
 protected:
    void SetUp() override {
        scratch_.write("vendors/faulty.icd", std::string(FAULTY_DRIVER) + "\n");
        scratch_.write("a.scene", kScene);
        fs::create_directories(scratch_.path("tmp"));
        fs::create_directories(scratch_.path("out"));
    }
    // Every process of a run has this in its environment. The driver makes the file when it begins to hang.
    std::string mark() const { return scratch_.path("mark"); }
    RunOptions signalled_when_it_hangs(int signal) const {
        fs::remove(mark());
        RunOptions options;
        options.signal = signal;
        options.signal_when_made = mark();
        return options;
    }
    ProgramResult render(const std::string& fault, RunOptions options = {}, const std::vector<std::string>& more = {}) {
        auto& env = options.environment;
        env.insert({{"OCL_ICD_VENDORS", scratch_.path("vendors")},
                    {"CLARITY_FAULT", fault},
                    {"CLARITY_FAULT_MARK", mark()},
                    {"CLARITY_PROGRAM_CACHE", scratch_.path("programs")},
                    {"CLARITY_COMPILE", ""},
                    {"CLARITY_DEVICE", ""},
                    {"TMPDIR", scratch_.path("tmp")}});
        std::vector<std::string> words = {
            "render", scratch_.path("a.scene"), "-o", scratch_.path("out/a.png"), "--size", "32x32", "--lanes", "1", "--accel",
            "linear"};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_program(words, options);
        expect_nothing_left();
        return result;
    }
    bool has_picture() const { return fs::exists(scratch_.path("out/a.png")); }
    // No process of the run, no temporary file, no half picture. A killed process may need a moment.
    void expect_nothing_left() const {
        EXPECT_TRUE(clarity::test::comes([&] { return processes().empty(); })) << processes();
        EXPECT_TRUE(fs::is_empty(scratch_.path("tmp"))) << fs::directory_iterator(scratch_.path("tmp"))->path();
        for (const char* folder : {"out", "programs"}) {
            std::error_code error;
            for (const auto& file : fs::directory_iterator(scratch_.path(folder), error))
                EXPECT_NE(file.path().extension(), ".tmp") << file.path();
        }
    }
    std::string processes() const {
        std::string all;
        for (const auto& process : fs::directory_iterator("/proc")) {
            std::ifstream file(process.path() / "environ", std::ios::binary);
            const std::string text(std::istreambuf_iterator<char>(file), {});
            if (text.find("CLARITY_FAULT_MARK=" + mark()) != std::string::npos) all += process.path().filename().string() + " ";
        }
        return all;
    }
    static void expect_says(const ProgramResult& result, const std::string& text) {
        EXPECT_NE(result.err.find(text), std::string::npos) << "expected: " << text << "\nread: " << result.err;
    }
    Scratch scratch_;
};

TEST_F(Faults, NoneRendersAndTheSecondStartCompilesNothing) {
    const ProgramResult first = render("other");
    EXPECT_EQ(first.exit_code, 0) << first.err;
    fs::remove(scratch_.path("out/a.png"));
    const ProgramResult second = render("other,no-source");
    EXPECT_EQ(second.exit_code, 0) << "both programs are loaded from their binaries: " << second.err;
    EXPECT_TRUE(has_picture());
}

// PoCL's cache is empty at each start. The binaries in the store are enough to render without a compilation.
TEST_F(Faults, PoclLoadsItsBinariesToo) {
    ASSERT_EQ(render("").exit_code, 0);
    fs::remove(scratch_.path("out/a.png"));
    const ProgramResult second = render("no-source");
    EXPECT_EQ(second.exit_code, 0) << "both programs are loaded from their binaries: " << second.err;
    EXPECT_TRUE(has_picture());
}

// Of a program for which PoCL is slow to make a binary, the store has what PoCL has compiled.
TEST_F(Faults, ProgramsWithoutABinaryAreKeptToo) {
    scratch_.write("rays.txt", "0 0 5 0 0 0 -1 100\n");
    const auto trace = [&] {
        RunOptions options;
        options.environment = {
            {"CLARITY_PROGRAM_CACHE", scratch_.path("programs")}, {"CLARITY_COMPILE", ""}, {"TMPDIR", scratch_.path("tmp")}};
        const ProgramResult result = run_program({"trace", scratch_.path("a.scene"), "--rays", scratch_.path("rays.txt"), "-o",
                                                  scratch_.path("hits.txt"), "--accel", "linear", "-v"},
                                                 options);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        expect_nothing_left();
        return scratch_.read("hits.txt");
    };
    const std::string hits = trace();
    std::map<fs::path, std::string> kept;
    for (const auto& file : fs::directory_iterator(scratch_.path("programs"))) {
        const std::string content = scratch_.read("programs/" + file.path().filename().string());
        if (content.find("trace_rays.so") != std::string::npos) kept[file.path()] = content;
    }
    EXPECT_EQ(kept.size(), 1u) << "the form that was launched, too";
    EXPECT_EQ(trace(), hits);
    for (const auto& [path, content] : kept)
        EXPECT_TRUE(scratch_.read("programs/" + path.filename().string()) == content) << "nothing was compiled again";
}

TEST_F(Faults, ASignalEndsABuildThatHangs) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const ProgramResult result =
            render(signal == SIGINT ? "build-hangs" : "other,build-hangs", signalled_when_it_hangs(signal));
        EXPECT_EQ(result.exit_code, 130) << result.err;
        EXPECT_LT(result.seconds_after_signal, clarity::test::at_most(1)) << "the signal must end the program within a second";
        expect_says(result, "interrupted");
        EXPECT_FALSE(has_picture());
    }
}

TEST_F(Faults, ASignalEndsABuildInThisProcess) {
    RunOptions options = signalled_when_it_hangs(SIGTERM);
    options.environment["CLARITY_COMPILE"] = "here";
    const ProgramResult result = render("build-hangs", options);
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_LT(result.seconds_after_signal, clarity::test::at_most(1));
    expect_says(result, "the OpenCL driver did not stop");
}

TEST_F(Faults, ASignalEndsALaunchThatHangs) {
    ASSERT_EQ(render("").exit_code, 0);
    fs::remove(scratch_.path("out/a.png"));
    const ProgramResult result = render("launch-hangs", signalled_when_it_hangs(SIGINT));
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_LT(result.seconds_after_signal, clarity::test::at_most(1));
    EXPECT_FALSE(has_picture());
}

TEST_F(Faults, ALongBuildIsToldAndCanBeLeft) {
    RunOptions options;
    options.signal = SIGINT;
    options.signal_when = "the OpenCL compiler has been at work for 1 s";
    options.environment["CLARITY_COMPILE_PATIENCE"] = "0.5";
    const ProgramResult result = render("build-hangs", options);
    EXPECT_EQ(result.exit_code, 130);
    expect_says(result, options.signal_when);
    expect_says(result, "--lanes 1");
}

TEST_F(Faults, ACompilerThatCrashesIsAMessageWithItsLog) {
    const ProgramResult result = render("build-crashes");
    EXPECT_EQ(result.exit_code, 5) << result.err;
    expect_says(result, "the OpenCL compiler crashed: aborted");
    expect_says(result, "Instruction does not dominate all uses!");
    EXPECT_FALSE(has_picture());
}

// LLVM 18 ends the process at some programs. The second start knows which way the program was compiled.
TEST_F(Faults, ACompilerThatCrashesIsTriedInOtherWays) {
    const struct {
        const char *driver, *fault, *way;
    } cases[] = {{"", "method-crashes", "compiling again in another way"},
                 {"", "optimiser-crashes", "compiling again without the compiler's optimiser"},
                 {"other,", "optimiser-crashes", "compiling again without the compiler's optimiser"}};
    for (const auto& c : cases) {
        SCOPED_TRACE(std::string(c.driver) + c.fault);
        fs::remove_all(scratch_.path("programs"));
        const ProgramResult first = render(std::string(c.driver) + c.fault);
        EXPECT_EQ(first.exit_code, 0) << first.err;
        expect_says(first, "the OpenCL compiler crashed: aborted");
        expect_says(first, c.way);
        EXPECT_TRUE(has_picture());
        fs::remove(scratch_.path("out/a.png"));
        const ProgramResult second = render(c.driver + std::string(c.fault) + ",no-source");
        EXPECT_EQ(second.exit_code, 0) << "both programs are loaded from their binaries: " << second.err;
        EXPECT_EQ(second.err.find("compiling again"), std::string::npos) << second.err;
        EXPECT_TRUE(has_picture());
        fs::remove(scratch_.path("out/a.png"));
    }
}

TEST_F(Faults, ACompilerThatEndsItsProcessIsAMessage) {
    const ProgramResult result = render("build-exits");
    EXPECT_EQ(result.exit_code, 5) << result.err;
    expect_says(result, "the OpenCL compiler ended its process: exit code 3");
}

TEST_F(Faults, ACompilerThatRefusesWithoutALogIsAMessage) {
    const ProgramResult result = render("build-refuses");
    EXPECT_EQ(result.exit_code, 5) << result.err;
    expect_says(result, "OpenCL error -11 (compiling tracer iterative with accel linear for");
}

TEST_F(Faults, ACompilerThatEatsMemoryIsStopped) {
    RunOptions options;
    options.environment["CLARITY_COMPILE_MEMORY"] = "300";
    const ProgramResult result = render("build-eats", options);
    EXPECT_EQ(result.exit_code, 5) << result.err;
    expect_says(result, "needs more than 300 MiB of memory");
}

TEST_F(Faults, BinariesThatTheDriverRefusesAreCompiledAgain) {
    const ProgramResult result = render("other,binary-flipped");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(has_picture());
}

TEST_F(Faults, AStoredProgramThatIsDamagedIsCompiledAgain) {
    ASSERT_EQ(render("other").exit_code, 0);
    for (const auto& file : fs::directory_iterator(scratch_.path("programs"))) {
        std::fstream stored(file.path(), std::ios::binary | std::ios::in | std::ios::out);
        stored.seekp(100);
        stored.put('\x55');
    }
    fs::remove(scratch_.path("out/a.png"));
    const ProgramResult result = render("other");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(has_picture());
}

// PoCL aborts on a damaged cache, and builds nothing if it cannot write there. It gets a folder of the process's own.
TEST_F(Faults, ACacheOfPoclThatIsDamagedIsGoneRound) {
    const std::vector<std::string> simple = {"--depth", "1", "--aov", "t"};
    RunOptions options;
    options.environment["POCL_CACHE_DIR"] = scratch_.path("kcache");
    options.environment["CLARITY_COMPILE"] = "here";  // fills it
    ASSERT_EQ(render("", options, simple).exit_code, 0);
    size_t damaged = 0;
    for (const auto& file : fs::recursive_directory_iterator(scratch_.path("kcache"))) {
        if (!file.is_regular_file() || file.file_size() < 200) continue;
        fs::resize_file(file.path(), 100);
        ++damaged;
    }
    EXPECT_GE(damaged, 2u);
    options.environment["CLARITY_COMPILE"] = "";
    for (const char* start : {"cold", "warm"}) {
        fs::remove(scratch_.path("out/a.png"));
        const ProgramResult result = render("", options, simple);
        EXPECT_EQ(result.exit_code, 0) << start << ": " << result.err;
        EXPECT_TRUE(has_picture()) << start;
    }
}

TEST_F(Faults, ACacheOfPoclThatCannotBeWrittenIsGoneRound) {
    scratch_.write("file", "");  // no folder can be made below it, also not by root
    RunOptions options;
    options.environment["POCL_CACHE_DIR"] = scratch_.path("file/kcache");
    ProgramResult result = render("", options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(has_picture());
    // Nor where temporary files are: then it is below the program's cache folder.
    fs::remove(scratch_.path("out/a.png"));
    options.environment["TMPDIR"] = scratch_.path("file");
    options.environment["XDG_CACHE_HOME"] = scratch_.path("cache");
    result = render("", options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(has_picture());
    EXPECT_TRUE(fs::exists(scratch_.path("cache/clarity"))) << "and it is gone at the end";
    EXPECT_FALSE(fs::exists(scratch_.path("cache/clarity/pocl")));
}

TEST_F(Faults, ACacheOfPoclThatCannotBeWrittenIsNamedWhereItMustServe) {
    scratch_.write("file", "");
    RunOptions options;
    options.environment["CLARITY_COMPILE"] = "here";
    options.environment["POCL_CACHE_DIR"] = scratch_.path("file/kcache");
    options.environment["XDG_CACHE_HOME"] = scratch_.path("cache");
    const ProgramResult result = render("", options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    expect_says(result, "PoCL's cache " + scratch_.path("file/kcache") + " cannot be written");
    expect_says(result, scratch_.path("cache/clarity/pocl") + " is used instead");
    EXPECT_TRUE(has_picture());
}

TEST_F(Faults, EveryFailureOfACallIsAMessage) {
    ASSERT_EQ(render("").exit_code, 0);
    fs::remove(scratch_.path("out/a.png"));
    struct Case {
        const char *fault, *says;
    };
    for (const Case& one : {Case{"enqueue=-5@1", "OpenCL error -5"}, Case{"enqueue=-4@2", "OpenCL error -4 (out of memory)"},
                            Case{"enqueue=-6@2", "OpenCL error -6"}, Case{"enqueue=-36@2", "OpenCL error -36"},
                            Case{"enqueue=-54@2", "OpenCL error -54"}, Case{"buffer=-4@1", "no room on"},
                            Case{"buffer=-4@5", "no room on"}, Case{"buffer=-61@3", "OpenCL error -61"},
                            Case{"read=-5@1", "OpenCL error -5"}, Case{"read=-36@1", "OpenCL error -36"}}) {
        const ProgramResult result = render(one.fault);
        EXPECT_EQ(result.exit_code, 1) << one.fault << ": " << result.err;
        expect_says(result, one.says);
        EXPECT_FALSE(has_picture()) << one.fault;
    }
}

// A GPU's launch that never ends: nothing can stop it, and releasing anything on the device would wait for it.
TEST_F(Faults, ALaunchWithoutEndIsGivenUp) {
    ASSERT_EQ(render("other,gpu").exit_code, 0);
    for (const char* tracer : {"iterative", "wavefront"})
        for (const char* from : {"1", "2", "3"}) {
            fs::remove(scratch_.path("out/a.png"));
            RunOptions options = signalled_when_it_hangs(0);
            options.environment["CLARITY_LAUNCH_LIMIT"] = "1.5";
            const ProgramResult result = render(std::string("other,gpu,launch-endless=") + from, options, {"--tracer", tracer});
            EXPECT_EQ(result.exit_code, 1) << tracer << " " << from << ": " << result.err;
            EXPECT_GT(result.seconds, 1.5);
            EXPECT_LT(result.seconds_after_signal, clarity::test::at_most(1.5 + 5)) << "the limit once";
            expect_says(result, "has not come to an end on ");
            expect_says(result, "CLARITY_LAUNCH_LIMIT");
            EXPECT_FALSE(has_picture());
        }
}

TEST_F(Faults, ADeviceThatIsLostIsNamedAsSuch) {
    ASSERT_EQ(render("other,gpu").exit_code, 0);
    for (const char* fault : {"enqueue=-2@2", "enqueue=-34@1", "read=-36@1"}) {
        fs::remove(scratch_.path("out/a.png"));
        const ProgramResult result = render(std::string("other,gpu,") + fault);
        EXPECT_EQ(result.exit_code, 1) << fault << ": " << result.err;
        expect_says(result, "the device cannot be used until it is opened anew");
        EXPECT_FALSE(has_picture()) << fault;
    }
}

}  // namespace
