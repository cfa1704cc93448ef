#include "cli/help/man_page.hpp"

#include <CLI/CLI.hpp>

#include "view/settings/settings.hpp"

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

std::string joined(const std::vector<std::string>& words, const char* between) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
    return out;
}

// Names with their dashes, short ones first.
std::vector<std::string> names(const CLI::Option& option) {
    std::vector<std::string> all;
    for (const std::string& name : option.get_snames()) all.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) all.push_back("--" + name);
    return all;
}

// The values that an option accepts, separated by blanks; empty where it is no choice among few.
std::string choices(const CLI::Option& option) {
    for (const Setting& setting : settings_table()) {
        std::string name = setting.key;
        for (char& c : name)
            if (c == '_') c = '-';
        if (!option.check_lname(name)) continue;
        if (setting.kind == Setting::Kind::boolean) return "true false";
        return joined(setting.choices, " ");
    }
    // A check for membership shows as {a,b} in the type.
    const std::string type = option.get_type_name();
    const size_t begin = type.find('{'), end = type.find('}');
    if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
    std::string values = type.substr(begin + 1, end - begin - 1);
    for (char& c : values)
        if (c == ',') c = ' ';
    return values;
}

// The cases of one command: the values of its options that choose among few, and the list of all of its options.
std::string cases(const CLI::App& command) {
    std::vector<std::string> all, free;
    std::string out = "        case $before in\n";
    for (const CLI::Option* option : command.get_options()) {
        const std::vector<std::string> mine = names(*option);
        all.insert(all.end(), mine.begin(), mine.end());
        if (mine.empty() || option->get_items_expected_max() == 0) continue;
        const std::string values = choices(*option);
        if (values.empty())
            free.insert(free.end(), mine.begin(), mine.end());
        else
            out += "        " + joined(mine, "|") + ") words=\"" + values + "\" ;;\n";
    }
    // The value of any other option is a number or a file: bash completes files where we offer nothing.
    if (!free.empty()) out += "        " + joined(free, "|") + ") return ;;\n";
    return out + "        *) [[ $word == -* ]] && words=\"" + joined(all, " ") + "\" ;;\n        esac\n";
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

std::string bash_completion(const CLI::App& app) {
    const std::vector<const CLI::App*> commands = app.get_subcommands([](const CLI::App*) { return true; });
    std::vector<std::string> first;
    for (const CLI::App* command : commands) first.push_back(command->get_name());
    std::string all = joined(first, " ");
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : names(*option)) all += " " + name;
    std::string out =
        "# Completion of clarity for bash: made by `clarity --help-as bash`.\n"
        "_clarity() {\n"
        "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} words=\"\"\n"
        "    COMPREPLY=()\n"
        "    if ((COMP_CWORD == 1)); then\n"
        "        COMPREPLY=($(compgen -W \"" +
        all +
        "\" -- \"$word\") $(compgen -f -- \"$word\"))\n"
        "        return\n"
        "    fi\n"
        "    case $command in\n";
    for (const CLI::App* command : commands) out += "    " + command->get_name() + ")\n" + cases(*command) + "        ;;\n";
    return out +
           "    esac\n"
           "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
           "}\n"
           "complete -o default -o filenames -F _clarity clarity\n";
}

}  // namespace clarity
