// own_folder.hpp -- whether a folder is safe below one that others may write to.
#pragma once
#include <filesystem>

namespace clarity {

// Whether this is a folder of this user, and no link to one, in which nobody else may write.
bool is_own_folder(const std::filesystem::path& folder);
// Makes such a folder, unless it is there. Returns whether it is one then. Code that is loaded must be in such folders.
bool make_own_folder(const std::filesystem::path& folder);

}  // namespace clarity
