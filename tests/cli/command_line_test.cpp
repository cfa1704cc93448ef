// command_line_test.cpp -- the arguments which are accepted and refused, and the exit codes which scripts rely on.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

constexpr const char* kScene =
    "camera main eye 0 1 6 target 0 1 0 fov 40\n"
    "camera side eye 6 1 0 target 0 1 0 fov 40\n"
    "light point position 3 6 4\n"
    "sphere center 0 1 0 radius 1\n";

size_t line_count(const std::string& text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST(CommandLine, HelpAndVersionGoToStdout) {
    const char* commands[] = {"", "view", "render", "info", "devices", "plugins"};
    for (const std::string command : commands) {
        std::vector<std::string> words;
        if (!command.empty()) words.push_back(command);
        words.push_back("--help");
        const ProgramResult result = run_program(words);
        EXPECT_EQ(result.exit_code, 0) << command;
        EXPECT_NE(result.out.find("Usage: clarity" + (command.empty() ? "" : " " + command)), std::string::npos) << result.out;
        EXPECT_NE(result.out.find("Exit codes:"), std::string::npos);
        EXPECT_EQ(result.err, "") << command;
        EXPECT_EQ(result.out.find("import-worker"), std::string::npos) << "the import worker is internal";
    }
    const ProgramResult version = run_program({"--version"});
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_EQ(version.out.rfind("clarity ", 0), 0u) << version.out;
    EXPECT_NE(version.out.find("\nwindow: "), std::string::npos) << version.out;
}

TEST(CommandLine, RenderHelpListsEverySetting) {
    const std::string help = run_program({"render", "--help"}).out;
    for (const char* option : {"--device",
                               "--accel",
                               "--tracer",
                               "--depth",
                               "--packet",
                               "--lanes",
                               "--size",
                               "--spp",
                               "--camera",
                               "--light",
                               "--frames",
                               "--skip-existing",
                               "--clip",
                               "--fps",
                               "--time",
                               "--repeat",
                               "--set",
                               "--aov",
                               "--stats",
                               "--log-file",
                               "--plugin",
                               "--import-in-process",
                               "--search-path",
                               "-v,",
                               "-q,"})
        EXPECT_NE(help.find(option), std::string::npos) << option;
}

TEST(CommandLine, UsageErrorsAreOneLineAndExit2AndWriteNothing) {
    const Scratch scratch;
    const std::string scene = scratch.write("a.scene", kScene), out = scratch.path("out.png");
    std::filesystem::create_directory(scratch.path("folder.png"));
    struct Case {
        std::vector<std::string> words;
        std::string named;  // what the message must name
    };
    const std::vector<Case> cases = {
        {{"render"}, "scene"},
        {{"render", scene}, "output"},
        {{"render", scene, "-o"}, "output"},
        {{"render", scene, "-o", scratch.path("a.jpg")}, ".pfm"},
        {{"render", scene, "-o", scratch.path("missing/a.png")}, "missing/a.png"},
        {{"render", scene, "-o", scratch.path("folder.png")}, "folder.png"},
        {{"render", scene, "-o", out, "--bogus"}, "--bogus"},
        {{"render", scene, "-o", out, "--size", "0x10"}, "0x10"},
        {{"render", scene, "-o", out, "--size", "1024"}, "1024"},
        {{"render", scene, "-o", out, "--size", "-64x48"}, "-64x48"},
        {{"render", scene, "-o", out, "--size", "99999999999x1"}, "99999999999x1"},
        {{"render", scene, "-o", out, "--depth", "0"}, "depth"},
        {{"render", scene, "-o", out, "--depth", "3.5"}, "3.5"},
        {{"render", scene, "-o", out, "--lanes", "3"}, "lanes"},
        {{"render", scene, "-o", out, "--packet", "4"}, "packet"},
        {{"render", scene, "-o", out, "--spp", "0"}, "spp"},
        {{"render", scene, "-o", out, "--tracer", "none"}, "iterative"},
        {{"render", scene, "-o", out, "--aov", "depth"}, "normal"},
        {{"render", scene, "-o", out, "--accel", "nothing"}, "bvh2"},
        {{"render", scene, "-o", out, "--accel", "bvh2,"}, "bvh2"},
        {{"render", scene, "-o", out, "--accel", "bvh2,max_leaf"}, "max_leaf"},
        {{"render", scene, "-o", out, "--accel", "bvh2,max_leaf=0"}, "max_leaf"},
        {{"render", scene, "-o", out, "--accel", "bvh2,unknown=1"}, "unknown"},
        {{"render", scene, "-o", out, "--set", "depth"}, "key=value"},
        {{"render", scene, "-o", out, "--set", "unknown=1"}, "unknown"},
        {{"render", scene, "-o", out, "--frames", "1-3"}, "####"},
        {{"render", scene, "-o", out, "--frames", "3-1"}, "3-1"},
        {{"render", scene, "-o", out, "--frames", "1-3/0"}, "1-3/0"},
        {{"render", scene, "-o", out, "--frames", "a"}, "--frames a"},
        {{"render", scene, "-o", out, "--frames", "99999999999"}, "99999999999"},
        {{"render", scene, "-o", out, "--repeat", "0"}, "--repeat"},
        {{"render", scene, "-o", out, "--repeat", "-1"}, "--repeat"},
        {{"render", scene, "-o", out, "--repeat", "4294967295"}, "1000000"},
        {{"render", scene, "-o", out, "--preset", "/dev/zero"}, "/dev/zero: is no regular file"},
        {{"render", scene, "-o", out, "--preset", scratch.path("folder.png")}, "folder.png: is a folder"},
        {{"render", scene, "-o", out, "--preset", scratch.path("missing.json")}, "missing.json: cannot be read: No such file"},
        {{"render", scene, "-o", out, "--time", "nan"}, "--time"},
        {{"render", scene, "-o", out, "--camera", "1,2,3"}, "1,2,3"},
        {{"render", scene, "-o", out, "--camera", "0,0,0,0,0,0"}, "--camera"},
        {{"render", scene, "-o", out, "--camera", "0,0,5,0,0,0,180"}, "180"},
        {{"render", scene, "-o", out, "--camera", "nobody"}, "main, side"},
        {{"render", scene, "-o", out, "--light", "1,2"}, "1,2"},
        {{"render", scene, "-o", out, "--stats", scratch.path("missing/s.json")}, "missing/s.json"},
        {{"render", scene, "-o", out, "--log-file", scratch.path("missing/l.txt")}, "missing/l.txt"},
        {{"render", scene, "-o", out, "--trace", scratch.path("missing/t.json")}, "missing/t.json"},
        {{"render", scene, "-o", out, "-v", "-q"}, "quiet"},
        {{"info"}, "scene"},
        {{"info", scene, "--size", "1x1"}, "--size"},
        {{"devices", "extra"}, "extra"},
        {{"view", scene, "--keys", "none"}, "--keys"},
        {{"--bogus"}, "--bogus"},
    };
    for (const Case& c : cases) {
        std::string typed;
        for (const std::string& word : c.words) typed += word + " ";
        const ProgramResult result = run_program(c.words);
        EXPECT_EQ(result.exit_code, 2) << typed << "\n" << result.err;
        EXPECT_EQ(result.out, "") << typed;
        EXPECT_EQ(line_count(result.err), 1u) << typed << "\n" << result.err;
        EXPECT_NE(result.err.find(c.named), std::string::npos) << typed << "\n" << result.err;
    }
    std::vector<std::string> left;
    for (const auto& entry : std::filesystem::directory_iterator(scratch.path("")))
        left.push_back(entry.path().filename().string());
    std::sort(left.begin(), left.end());
    EXPECT_EQ(left, (std::vector<std::string>{"a.scene", "folder.png"}));
}

// Control characters in names and messages which come from files are escaped, so that the terminal does not execute them.
TEST(CommandLine, EscapesInNamesAndMessagesAreShown) {
    const Scratch scratch;
    const std::string name = "a\x1b]0;owned\x07\x1b[2J.scene", log = scratch.path("log.txt");
    const std::string scene =
        scratch.write(name, "camera \"c\x1b[31m\" eye 0 0 5 target 0 0 0 fov 40\nsphere center 0 0 0 radius 1\n");
    const std::string broken = scratch.write("\x1b[31mb.scene", "sphere \x1b[2J\n");
    std::string all;
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"info", scene}, std::vector<std::string>{"info", broken, "--log-file", log},
          std::vector<std::string>{"info", scratch.path("\x1b[2Jmissing")},
          std::vector<std::string>{"render", scene, "-o", scratch.path("\x1b[2J/a.png")},
          std::vector<std::string>{"render", scene, "-o", scratch.path("a.png"), "--\x1b[2J"}}) {
        const ProgramResult result = run_program(words);
        EXPECT_EQ((result.out + result.err).find_first_of("\x1b\x07"), std::string::npos) << result.out << result.err;
        EXPECT_NE((result.out + result.err).find("\\x1b["), std::string::npos) << result.out << result.err;
    }
    EXPECT_EQ(scratch.read("log.txt").find('\x1b'), std::string::npos);
    EXPECT_NE(scratch.read("log.txt").find("\\x1b[31mb.scene"), std::string::npos);
}

TEST(CommandLine, ARefusedPluginNamedByTheUserIsAnError) {
    const Scratch scratch;
    const std::string scene = scratch.write("a.scene", kScene), library = scratch.write("bad.so", "no library");
    const ProgramResult result = run_program({"info", scene, "--plugin", library});
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(library), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
}

TEST(CommandLine, FilesThatCannotBeImportedExit4) {
    const Scratch scratch;
    std::filesystem::create_directory(scratch.path("folder"));
    const std::string cases[] = {scratch.path("missing.fbx"),
                                 scratch.path("folder"),
                                 "/dev/null",
                                 scratch.write("noise.bin", "\x01\x02 no scene at all"),
                                 scratch.write("empty.obj", ""),
                                 scratch.write("bad.scene", "sphere center 0 0\n")};
    for (const std::string& file : cases)
        for (const std::vector<std::string>& words :
             {std::vector<std::string>{"info", file},
              std::vector<std::string>{"render", file, "-o", scratch.path("out.png")}}) {
            const ProgramResult result = run_program(words);
            EXPECT_EQ(result.exit_code, 4) << file << "\n" << result.err;
            EXPECT_NE(result.err.find(std::filesystem::path(file).filename().string()), std::string::npos) << result.err;
            EXPECT_EQ(result.out, "") << file;
        }
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out.png")));
}

TEST(CommandLine, ATypingErrorInACommandIsExplained) {
    const ProgramResult result = run_program({"rendr"});
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_NE(result.err.find("clarity --help"), std::string::npos) << result.err;
}

TEST(CommandLine, TheWindowWithoutADisplaySaysHowToRender) {
    const Scratch scratch;
    const std::string scene = scratch.write("a.scene", kScene);
    for (const std::vector<std::string>& words : {std::vector<std::string>{scene}, std::vector<std::string>{"view", scene}}) {
        RunOptions options;
        options.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
        const ProgramResult result = run_program(words, options);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_NE(result.err.find("clarity render"), std::string::npos) << result.err;
        EXPECT_EQ(result.out, "");
    }
}

TEST(CommandLine, TheImportWorkerAloneDoesNotHang) {
    RunOptions options;
    options.limit_s = 20;
    const ProgramResult result = run_program({"import-worker"}, options);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_LT(result.exit_code, 128) << "killed by a signal";
    EXPECT_LT(result.seconds, 10);
}

TEST(CommandLine, AFullDiskUnderStdoutIsAFailure) {
    RunOptions options;
    options.stdout_path = "/dev/full";
    const ProgramResult result = run_program({"plugins"}, options);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("stdout"), std::string::npos) << result.err;
}
