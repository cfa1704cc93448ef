// tracer_choice.hpp -- what settings, and all that stands on them, know of tracers.
#pragma once
#include <string>
#include <vector>

namespace clarity {

// What Whitted's model gives: of tracers that shade by cl/shading/shading.h.
inline constexpr const char* kWhittedPicture = "whitted";
// What physics gives: of the tracer `path`.
inline constexpr const char* kPathPicture = "path";

struct TracerChoice {
    const char* id = "";    // of the setting `tracer`, and the name of its folders
    const char* help = "";  // for the setting
    const char* when = "";  // where `auto` takes it: "on a GPU if nothing refracts"; empty: where no other is taken
    // What its pictures show, with the same settings. Tracers of which it is the same make the same picture, apart from last
    // bits: a finished frame of one serves as one of the other, and a checkpoint goes on with the other.
    const char* picture = "";
};

// The tracers that users may choose, in their order. Defined with all tracers, in tracers/tracers.cpp, which is above.
const std::vector<TracerChoice>& tracer_choices();

// The choices of the setting `tracer`, `auto` first, and their help.
std::vector<std::string> tracer_names();
std::string tracer_help();
// TracerChoice::picture of the setting's value. Those that `auto` takes have the same.
std::string picture_of_tracer(const std::string& name);

}  // namespace clarity
