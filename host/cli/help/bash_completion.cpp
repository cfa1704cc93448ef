#include "cli/help/bash_completion.hpp"

#include <CLI/CLI.hpp>

#include "render/settings/settings.hpp"

namespace clarity {
namespace {

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
