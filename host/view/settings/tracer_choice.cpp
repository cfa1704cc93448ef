#include "view/settings/settings.hpp"

namespace clarity {

std::vector<std::string> tracer_names() {
    std::vector<std::string> names{"auto"};
    for (const TracerChoice& choice : tracer_choices()) names.emplace_back(choice.id);
    return names;
}

std::string tracer_help() {
    std::string help, automatic = "auto: ", otherwise;
    for (const TracerChoice& choice : tracer_choices()) {
        help += std::string(choice.id) + ": " + choice.help + "; ";
        if (*choice.when)
            automatic += std::string(choice.id) + " " + choice.when + ", ";
        else if (otherwise.empty())
            otherwise = choice.id;
    }
    return help + automatic + "else " + otherwise;
}

std::string picture_of_tracer(const std::string& name) {
    for (const TracerChoice& choice : tracer_choices())
        if (name == choice.id) return choice.picture;
    return tracer_choices().front().picture;
}

}  // namespace clarity
