// collada_pictures.hpp -- what COLLADA says of pictures and assimp does not pass on: the wrap modes of their samplers (it reads
// those of Maya's extension only), what a picture of the transparency means, that its colour has a hue, and that there is one
// of the shininess.
#pragma once
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "rt_plugin.h"

namespace assimp_import {

using Wrap = std::pair<rt_u32, rt_u32>;  // RT_WRAP_... of u and v

// <transparent opaque="RGB_ZERO"> with a picture, and its <transparency>.
struct Transparency {
    std::string mode;
    double factor = 1;
};

struct ColladaPictures {
    // By file_name().
    std::map<std::string, Wrap> wraps;  // of those that do not repeat only
    std::map<std::string, Transparency> transparencies;
    std::set<std::string> shininess;  // names of materials with a picture of it
    std::set<std::string> hues;       // and of those whose transparency is a colour with a hue
    std::string differs;              // a picture that samplers wrap in several ways; the first one counts
};
ColladaPictures collada_pictures(std::string_view text);

// The name of the file that a reference means, as a key for the above: without folders and percent signs.
std::string file_name(std::string_view reference);

}  // namespace assimp_import
