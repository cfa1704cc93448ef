// collada_check.hpp -- finds what crashes assimp in XML files, before it reads them.
#pragma once
#include <string>
#include <string_view>

namespace assimp_import {

// Returns an empty string, or the place, what is there and what should be. It finds accessors of COLLADA that reach beyond
// their array, and elements inside each other that assimp follows by recursion. Everything else that is wrong assimp refuses
// itself.
std::string crash_in_xml(std::string_view text);

}  // namespace assimp_import
