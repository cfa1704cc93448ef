#include "base/files/own_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

namespace clarity {

bool is_own_folder(const std::filesystem::path& folder) {
    struct stat status {};
    return lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid() &&
           (status.st_mode & 022) == 0;
}

bool make_own_folder(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::filesystem::create_directories(folder.parent_path(), ignored);
    mkdir(folder.c_str(), 0700);
    return is_own_folder(folder);
}

}  // namespace clarity
