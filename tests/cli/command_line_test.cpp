// command_line_test.cpp -- the arguments which are accepted and refused, and the exit codes which scripts rely on.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cli/run_program.hpp"
#include "support/clock.hpp"
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
    const ProgramResult result = run_program({"import-worker"}, options);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_LT(result.exit_code, 128) << "killed by a signal";
    EXPECT_LT(result.seconds, clarity::test::at_most(10));
}

// Wherever the program writes: one message that names the file and the reason, exit code 1, and no file that is empty or cut
// off.
// `@` stands for the folder on a full disk. Where no file system of our own can be mounted, for links to /dev/full.
TEST(CommandLine, OutputOnAFullDiskIsAFailure) {
    if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
    const Scratch scratch;
    const std::string scene = scratch.write("a.scene", kScene), rays = scratch.write("rays", "0 0 5 0 0 0 -1 inf\n");
    const std::string made = scratch.path("made"), disk = scratch.path("disk"), a = made + "/a.pfm", b = made + "/b.pfm";
    for (const std::string& folder : {made, disk}) std::filesystem::create_directory(folder);
    const std::vector<std::string> render = {"render", scene, "--size", "16x16", "--accel", "linear", "-o"};
    struct Case {
        std::vector<std::string> words;
        std::string file;  // that cannot be written
    };
    std::vector<Case> cases = {
        {{"compare", a, b, "-o", "@/d.png"}, "d.png"},
        {{"trace", scene, "--rays", rays, "--accel", "linear", "-o", "@/hits.txt"}, "hits.txt"},
        {{"check", "scene", "--quick", "--only", "imports.table", "--junit", "@/j.xml"}, "j.xml"},
        {{"info", scene, "--trace", "@/t.json"}, "t.json"},
        {{"info", scene, "--log-file", "@/l.txt", "-v"}, "l.txt"},
        {{"why", scene, "--pixel", "8,8", "--size", "16x16", "--spp", "16", "--accel", "linear", "--csv", "@/w.csv"}, "w.csv"},
    };
    for (const char* name : {"@/p.png", "@/p.exr", "@/p.pfm"}) {
        cases.push_back({render, name + 2});
        cases.back().words.push_back(name);
    }
    const std::pair<std::vector<std::string>, std::string> beside[] = {
        {{"--stats", "@/s.json"}, "s.json"},
        {{"--trace", "@/t.json"}, "t.json"},
        {{"--tracer", "path", "--spp", "4000", "--checkpoint", "@/c.ckpt", "--every", "0.001"}, "c.ckpt"},
    };
    for (const auto& [words, file] : beside) {
        cases.push_back({render, file});
        cases.back().words.push_back(made + "/p.png");
        cases.back().words.insert(cases.back().words.end(), words.begin(), words.end());
    }
    for (const std::string& file : {a, b}) {
        std::vector<std::string> words = render;
        words.push_back(file);
        ASSERT_EQ(run_program(words).exit_code, 0);
    }
    // A disk of four pages that are all taken. What lies there in the end, and the program's exit code, are told in the last
    // lines.
    const std::string mount = "mount -t tmpfs -o size=16k none '" + disk + "'";
    const bool mounts = std::system(("unshare -rm sh -c \"" + mount + "\" 2>/dev/null").c_str()) == 0;
    for (const Case& c : cases) {
        RunOptions options;
        if (mounts)
            options.wrapper = {
                "unshare", "-rm", "sh", "-c",
                mount + " && cd '" + disk + "' && { cat /dev/zero >filler; \"$0\" \"$@\"; code=$?; ls -A; exit $code; }"};
        else if (!std::filesystem::is_symlink(disk + "/" + c.file))  // two cases may write one file
            std::filesystem::create_symlink("/dev/full", disk + "/" + c.file);
        std::vector<std::string> words = c.words;
        std::string typed;
        for (std::string& word : words) {
            if (word.rfind("@/", 0) == 0) word = disk + word.substr(1);
            typed += word + " ";
        }
        const ProgramResult result = run_program(words, options);
        EXPECT_EQ(result.exit_code, 1) << typed << "\n" << result.err;
        EXPECT_NE(result.err.find(c.file), std::string::npos) << typed << "\n" << result.err;
        EXPECT_NE(result.err.find("No space left on device; free some space"), std::string::npos) << typed << "\n"
                                                                                                  << result.err;
        if (!mounts) continue;
        EXPECT_TRUE(result.out == "filler\n" ||
                    (result.out.size() > 8 && result.out.substr(result.out.size() - 8) == "\nfiller\n"))
            << typed << "left something:\n"
            << result.out;
        EXPECT_EQ(result.out.find(c.file + "\n"), std::string::npos) << typed;
    }
}

TEST(CommandLine, AFullDiskUnderStdoutIsAFailure) {
    const Scratch scratch;
    const std::string scene = scratch.write("a.scene", kScene);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"plugins"}, std::vector<std::string>{"info", scene, "--json"},
          std::vector<std::string>{"bench", "quick", "--list"}, std::vector<std::string>{"--version"},
          std::vector<std::string>{"render", "--help"}, std::vector<std::string>{"--help-as", "man"}}) {
        RunOptions options;
        options.stdout_path = "/dev/full";
        const ProgramResult full = run_program(words, options);
        EXPECT_EQ(full.exit_code, 1) << words[0];
        EXPECT_NE(full.err.find("stdout cannot be written: "), std::string::npos) << full.err;
        // A file that is opened later must not take the number of a closed stdout, and get what is printed.
        options.stdout_path = {};
        options.wrapper = {"sh", "-c", "exec \"$0\" \"$@\" >&-"};
        std::vector<std::string> logged = words;
        if (words.size() > 1 && words[0] == "info") logged.insert(logged.end(), {"--log-file", scratch.path("log"), "-v"});
        const ProgramResult closed = run_program(logged, options);
        EXPECT_EQ(closed.exit_code, 1) << words[0];
        EXPECT_NE(closed.err.find("stdout cannot be written: "), std::string::npos) << closed.err;
    }
    EXPECT_EQ(scratch.read("log").find('{'), std::string::npos) << scratch.read("log");
}

namespace {

// The words of a command as bash splits them, without comments, pipes and redirections. Empty where a page stands for words by
// `...`, by brackets or by capital letters: SCENE, [--json], a|b.
std::vector<std::string> words_of_command(const std::string& line) {
    static const std::regex word(R"re("([^"]*)"|'([^']*)'|([^\s"']+))re");
    std::vector<std::string> words;
    for (std::sregex_iterator at(line.begin(), line.end(), word), end; at != end; ++at) {
        const bool is_quoted = !(*at)[3].matched;
        const std::string text = is_quoted ? (*at)[1].str() + (*at)[2].str() : (*at)[3].str();
        if (!is_quoted && (text[0] == '#' || text == "|" || text[0] == '>' || text == "&&" || text == "&" || text == ";"))
            break;
        const bool stands_for =
            !is_quoted && (text.find("...") != std::string::npos || text.find_first_of("[]|\\$*") != std::string::npos ||
                           std::regex_search(text, std::regex("(^|[=,/:])[A-Z]+([=,/:.]|$)")));
        if (stands_for) return {};
        words.push_back(text);
    }
    return words;
}

// Commands and options with their values, as pages have them: lines of blocks, and code within sentences.
std::set<std::vector<std::string>> commands_of_pages(std::map<std::vector<std::string>, std::string>& places) {
    namespace fs = std::filesystem;
    std::vector<fs::path> pages = {CLARITY_SOURCE_DIR "/README.md"};
    for (const auto& entry : fs::directory_iterator(CLARITY_SOURCE_DIR "/docs"))
        if (entry.path().extension() == ".md") pages.push_back(entry.path());
    std::set<std::vector<std::string>> commands;
    for (const fs::path& page : pages) {
        std::ifstream in(page);
        bool in_block = false;
        std::string line;
        for (int number = 1; std::getline(in, line); ++number) {
            std::vector<std::string> codes;
            if (line.rfind("```", 0) == 0) {
                in_block = !in_block;
            } else if (in_block) {
                // Some blocks explain each command behind it, with two blanks between.
                codes.push_back(std::regex_replace(line, std::regex("\\s{3,}.*$"), ""));
            } else {
                static const std::regex code("`([^`]+)`");
                for (std::sregex_iterator at(line.begin(), line.end(), code), end; at != end; ++at) codes.push_back((*at)[1]);
            }
            for (const std::string& text : codes) {
                std::vector<std::string> words = words_of_command(text);
                if (words.size() < 2) continue;
                if (words[0] == "clarity" || words[0] == "build/release/bin/clarity") {
                    words.erase(words.begin());
                    if (!in_block && words.size() < 5) continue;  // a sentence about the command
                } else if (words[0].rfind("--", 0) == 0 && words.size() == 2) {
                    words.insert(words.begin(), "render");
                } else {
                    continue;
                }
                commands.insert(words);
                places[words] = page.filename().string() + ":" + std::to_string(number);
            }
        }
    }
    return commands;
}

}  // namespace

// What a page says is typed is taken: an option that was renamed, or a value that no parser reads, is found here. Nothing is
// rendered: the scenes are not there (exit code 4), and `bench` only lists.
TEST(CommandLine, TakesWhatPagesSay) {
    const Scratch scratch;
    std::map<std::vector<std::string>, std::string> places;
    const std::string render_help = run_program({"render", "--help"}).out;
    const std::set<std::string> placeholders = {"WxH", "x,y,z", "key=value", "N-N", "d"};
    size_t tried = 0;
    for (const std::vector<std::string>& command : commands_of_pages(places)) {
        std::vector<std::string> words = command;
        const bool is_option = words.size() == 3 && words[1].rfind("--", 0) == 0;  // with its value, of `render` or of others
        if (is_option && render_help.find(words[1] + " ") == std::string::npos) continue;
        const auto is_unknown = [&](const std::string& word) { return placeholders.count(word) || word.rfind("my_", 0) == 0; };
        if (std::any_of(words.begin(), words.end(), is_unknown)) continue;
        words.erase(std::remove(words.begin(), words.end(), "--watch"), words.end());  // which waits for the scene
        const auto has = [&](const char* word) { return std::find(words.begin(), words.end(), word) != words.end(); };
        if (words[0] == "render") {
            if (!has("-o")) words.insert(words.end(), {"-o", has("--frames") ? "a_####.exr" : "a.exr"});
            words.insert(words.end(), {"none.scene", "--import-in-process"});
        } else if (words[0] == "bench") {
            words.emplace_back("--list");
        } else if (words[0] != "why" && words[0] != "info" && words[0] != "compare") {
            continue;
        }
        ++tried;
        RunOptions options;
        options.wrapper = {"sh", "-c", "cd '" + scratch.path("") + "' && exec \"$0\" \"$@\""};
        const ProgramResult result = run_program(words, options);
        const bool lacks_a_file = std::regex_search(result.err, std::regex("No such file|does not exist"));
        const bool lacks_a_device = result.exit_code == 3;
        EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 4 || lacks_a_file || lacks_a_device)
            << places[command] << ": " << result.err;
    }
    EXPECT_GT(tried, 60u) << "the pages are read in another way than they are written";
}
