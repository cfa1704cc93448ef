#include "base/files/known_contents.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "base/files/cache_folder.hpp"
#include "base/hash.hpp"

namespace clarity {

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
