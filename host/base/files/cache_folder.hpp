// cache_folder.hpp -- the folder of files that may be deleted at any time.
#pragma once
#include <filesystem>

namespace clarity {

// $XDG_CACHE_HOME/clarity, or ~/.cache/clarity; empty: there is none. It may not exist yet.
std::filesystem::path cache_folder();

}  // namespace clarity
