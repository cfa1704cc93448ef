#include "device/pocl_cache.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/files/cache_folder.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLeastBytes = 1 << 20;  // room for one program

// Where PoCL looks.
fs::path pocl_folder() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    if (const fs::path named = variable("POCL_CACHE_DIR"); !named.empty()) return named;
    if (const fs::path cache = variable("XDG_CACHE_HOME"); !cache.empty()) return cache / "pocl" / "kcache";
    if (const fs::path home = variable("HOME"); !home.empty()) return home / ".cache" / "pocl" / "kcache";
    return {};
}

// Writes a file there, which is gone afterwards. Returns why it failed; empty: it did not.
std::string why_unwritable(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return error.message();
    std::string name = (folder / "clarity-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) return std::strerror(errno);
    unlink(name.c_str());
    std::string why;
    if (const int failed = posix_fallocate(file, 0, kLeastBytes); failed != 0 && failed != EOPNOTSUPP && failed != EINVAL)
        why = std::strerror(failed);
    close(file);
    return why;
}

// Programs are loaded from the folder, so nobody else may write there.
bool is_own_folder(const fs::path& folder) {
    std::error_code ignored;
    fs::create_directories(folder.parent_path(), ignored);
    mkdir(folder.c_str(), 0700);
    struct stat status {};
    return lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid() &&
           (status.st_mode & 022) == 0;
}

}  // namespace

std::string pocl_cache() {
    return pocl_folder().string();
}

std::string use_writable_pocl_cache() {
    const fs::path folder = pocl_folder();
    if (folder.empty()) return {};
    const std::string why = why_unwritable(folder);
    if (why.empty()) return {};
    const std::string what = "PoCL's cache " + folder.string() + " cannot be written: " + why;
    std::vector<fs::path> others;
    if (const fs::path cache = cache_folder(); !cache.empty()) others.push_back(cache / "pocl");
    std::error_code error;
    if (const fs::path temporary = fs::temp_directory_path(error); !error)
        others.push_back(temporary / ("clarity-pocl-" + std::to_string(geteuid())));
    for (const fs::path& other : others) {
        if (!is_own_folder(other) || !why_unwritable(other).empty()) continue;
        setenv("POCL_CACHE_DIR", other.c_str(), 1);
        return what + "; " + other.string() + " is used instead";
    }
    return what + ", and no other folder either, so that nothing can be compiled: set POCL_CACHE_DIR to a folder with room";
}

}  // namespace clarity
