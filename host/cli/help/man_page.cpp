#include "cli/help/man_page.hpp"

#include <CLI/CLI.hpp>

namespace clarity {
namespace {

// Text for man(7): a backslash begins a command there, so does a point or an apostrophe at the beginning of a line. A plain
// hyphen would become a typographic one, which nobody can paste into a shell.
std::string escaped(const std::string& text) {
    std::string out;
    bool line_begins = true;
    for (const char c : text) {
        if (line_begins && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
        line_begins = c == '\n';
    }
    return out;
}

std::string upper(std::string text) {
    for (char& c : text)
        if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
    return text;
}

// Of a text of several lines, each line as one of its own.
std::string lines(const std::string& text) {
    std::string out;
    for (const char c : escaped(text)) out += c == '\n' ? std::string("\n.br\n") : std::string(1, c);
    return out + "\n";
}

// One row of the list: names and value in bold, the explanation below.
std::string row(const CLI::Option& option, bool positional) {
    const CLI::Formatter words;
    const std::string name = words.make_option_name(&option, positional), value = words.make_option_opts(&option);
    return ".TP\n\\fB" + escaped(name) + "\\fR" + escaped(value) + "\n" + escaped(words.make_option_desc(&option)) + "\n";
}

// All options of a command, group by group as in its help.
std::string options(const CLI::App& command) {
    std::string out;
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional()) out += row(*option, true);
    for (const std::string& group : command.get_groups()) {
        std::string rows;
        for (const CLI::Option* option : command.get_options())
            if (option->nonpositional() && option->get_group() == group && !group.empty()) rows += row(*option, false);
        if (!rows.empty()) out += ".PP\n" + escaped(group) + ":\n" + rows;
    }
    return out;
}

// The first line of a text.
std::string headline(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& version) {
    std::string what = headline(app.get_description());
    if (!what.empty() && what.back() == '.') what.pop_back();
    const std::string begin = "Clarity, ";
    if (what.compare(0, begin.size(), begin) == 0) what.erase(0, begin.size());
    std::string out = ".TH CLARITY 1 \"\" \"clarity " + escaped(version) + "\" \"User Commands\"\n";
    out += ".SH NAME\nclarity \\- " + escaped(what) + "\n.SH SYNOPSIS\n\\fBclarity\\fR [SCENE...]\n";
    const std::vector<const CLI::App*> commands = app.get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* command : commands) out += ".br\n\\fBclarity " + escaped(command->get_name()) + "\\fR [OPTIONS]...\n";
    out += ".SH DESCRIPTION\n" + lines(app.get_description()) + options(app);
    for (const CLI::App* command : commands)
        out +=
            ".SH CLARITY " + upper(escaped(command->get_name())) + "\n" + lines(command->get_description()) + options(*command);
    return out + ".SH EXIT CODES AND ENVIRONMENT\n" + lines(app.get_footer());
}

}  // namespace clarity
