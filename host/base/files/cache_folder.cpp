#include "base/files/cache_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/digest.hpp"

namespace clarity {

std::filesystem::path cache_folder() {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    if (cache && cache[0] == '/') return std::filesystem::path(cache) / "clarity";
    return home && home[0] == '/' ? std::filesystem::path(home) / ".cache" / "clarity" : std::filesystem::path();
}

bool is_own_folder(const std::filesystem::path& folder) {
    struct stat status{};
    return lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid() &&
           (status.st_mode & 022) == 0;
}

bool make_own_folder(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::filesystem::create_directories(folder.parent_path(), ignored);
    mkdir(folder.c_str(), 0700);
    return is_own_folder(folder);
}

std::string KnownContents::name_of(const std::string& content) {
    char name[40];
    std::snprintf(name, sizeof name, "%016llx-%zx", static_cast<unsigned long long>(hash_bytes(content.data(), content.size())),
                  content.size());
    return name;
}

bool KnownContents::has(const std::string& name) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::error_code error;
    return names_.count(name) || (!cache_folder().empty() && std::filesystem::exists(cache_folder() / folder_ / name, error));
}

void KnownContents::add(const std::string& name, const std::string& note) {
    const std::lock_guard<std::mutex> lock(mutex_);
    names_.insert(name);
    // The file is a convenience: without it later processes find out again.
    if (cache_folder().empty()) return;
    std::error_code error;
    std::filesystem::create_directories(cache_folder() / folder_, error);
    std::ofstream(cache_folder() / folder_ / name) << note << '\n';
}

}  // namespace clarity
