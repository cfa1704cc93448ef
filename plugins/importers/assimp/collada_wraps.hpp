// collada_wraps.hpp -- the wrap modes that samplers of COLLADA have. assimp reads those of Maya's extension only.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "rt_plugin.h"

namespace assimp_import {

using Wrap = std::pair<rt_u32, rt_u32>;  // RT_WRAP_... of u and v

struct ColladaWraps {
    std::map<std::string, Wrap> of_picture;  // by file_name(), of pictures that do not repeat only
    std::string differs;                     // a picture that samplers wrap in several ways; the first one counts
};
ColladaWraps collada_wraps(std::string_view text);

// The part of a path or URI behind its folders, with the characters that %20 and the like stand for.
std::string file_name(std::string_view reference);

}  // namespace assimp_import
