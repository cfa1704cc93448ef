// help_test.cpp -- the manual page and the completion name what the help of each command names.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "cli/run_program.hpp"

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) text.replace(at, what.size(), by);
    return text;
}

// All commands, as the manual page's synopsis lists them.
std::vector<std::string> commands_of(const std::string& page) {
    static const std::regex line("\\n\\\\fBclarity ([^ ]+)\\\\fR \\[OPTIONS\\]");
    std::vector<std::string> names;
    for (std::sregex_iterator at(page.begin(), page.end(), line), end; at != end; ++at)
        names.push_back(replaced((*at)[1], "\\-", "-"));
    return names;
}

// What the manual page says of a command.
std::string section_of(const std::string& page, std::string command) {
    for (char& c : command) c = char(std::toupper(c));
    const size_t section = page.find("\n.SH CLARITY " + replaced(command, "-", "\\-") + "\n");
    if (section == std::string::npos) return {};
    return page.substr(section + 1, page.find("\n.SH ", section + 1) - section);
}

// The options at the beginnings of the lines of a help text, by their long names.
std::set<std::string> options_of(const std::string& help) {
    static const std::regex line("(?:^|\\n)  (?:-[A-Za-z],)?(--[a-z-]+)");
    std::set<std::string> names;
    for (std::sregex_iterator at(help.begin(), help.end(), line), end; at != end; ++at) names.insert((*at)[1]);
    return names;
}

// What the script offers for the last of these words.
std::string completed(const std::string& script, const std::string& words) {
    FILE* pipe = popen(("bash -c '" + replaced(script, "'", "'\\''") + "\nCOMP_WORDS=(clarity " + words +
                        ") COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _clarity; echo \"${COMPREPLY[@]}\"'")
                           .c_str(),
                       "r");
    if (!pipe) return "popen failed";
    std::string out;
    std::array<char, 4096> block;
    while (std::fgets(block.data(), int(block.size()), pipe)) out += block.data();
    EXPECT_EQ(pclose(pipe), 0) << words;
    return out.substr(0, out.find('\n'));
}

}  // namespace

TEST(HelpAs, ThePageHasEveryOptionOfEveryCommand) {
    const ProgramResult page = run_program({"--help-as", "man"});
    ASSERT_EQ(page.exit_code, 0);
    EXPECT_EQ(page.err, "");
    EXPECT_EQ(page.out.compare(0, 12, ".TH CLARITY "), 0);
    EXPECT_GE(commands_of(page.out).size(), 12u);
    for (const std::string& command : commands_of(page.out)) {
        const ProgramResult help = run_program({command, "--help"});
        const std::set<std::string> options = options_of(help.out);
        EXPECT_GE(options.size(), 4u) << command;
        const std::string text = section_of(page.out, command);
        ASSERT_NE(text, "") << command;
        for (const std::string& option : options)
            EXPECT_TRUE(std::regex_search(text, std::regex(replaced(option, "-", "\\\\-") + "(,|\\\\fR)")))
                << command << " " << option;
    }
    EXPECT_NE(page.out.find("130 interrupted"), std::string::npos);
    // A line that begins with a point or an apostrophe must be one of man's commands.
    EXPECT_FALSE(std::regex_search(page.out, std::regex("\\n[.'](?!TH|SH|TP|PP|br)")));
}

// CLI11 2.4 takes `plugin` and `--plugin` of one command for one name, and refuses every command line then. Earlier ones do
// not.
TEST(HelpAs, NoPositionalHasTheNameOfAnOption) {
    const ProgramResult page = run_program({"--help-as", "man"});
    ASSERT_EQ(page.exit_code, 0);
    static const std::regex row("\\.TP\n\\\\fB([^\\\\-][^\\\\]*)\\\\fR");
    int positionals = 0;
    for (const std::string& command : commands_of(page.out)) {
        const std::string text = section_of(page.out, command);
        const std::set<std::string> options = options_of(run_program({command, "--help"}).out);
        for (std::sregex_iterator at(text.begin(), text.end(), row), end; at != end; ++at, ++positionals)
            EXPECT_EQ(options.count("--" + (*at)[1].str()), 0u) << command << " " << (*at)[1];
    }
    EXPECT_GE(positionals, 13);
}

TEST(HelpAs, BashCompletesCommandsOptionsAndValues) {
    const ProgramResult script = run_program({"--help-as", "bash"});
    ASSERT_EQ(script.exit_code, 0);
    const std::vector<std::string> commands = commands_of(run_program({"--help-as", "man"}).out);
    EXPECT_GE(commands.size(), 12u);
    for (const std::string& command : commands) {
        const std::string offered = " " + completed(script.out, command + " --") + " ";
        for (const std::string& option : options_of(run_program({command, "--help"}).out))
            EXPECT_NE(offered.find(" " + option + " "), std::string::npos) << command << " " << option;
    }
    EXPECT_EQ(completed(script.out, "ren"), "render");
    EXPECT_EQ(completed(script.out, "render --aov n"), "normal");
    EXPECT_EQ(completed(script.out, "render --shadows \"\""), "true false");
    EXPECT_EQ(completed(script.out, "view --keys v"), "viewer");
    EXPECT_EQ(completed(script.out, "render --stats \"\""), "") << "bash offers files then";
}

TEST(HelpAs, AnotherReaderIsRefused) {
    EXPECT_EQ(run_program({"--help-as", "latex"}).exit_code, 2);
    EXPECT_EQ(run_program({"--help-as"}).exit_code, 2);
}
