#include "plugin/trust.hpp"

#include <sys/stat.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>

#include "base/files/cache_folder.hpp"
#include "base/files/read_file.hpp"
#include "base/hash.hpp"
#include "plugin/registry.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxLibraryBytes = uint64_t{1} << 30;

std::string hash_of(const std::string& path) {
    std::string content;
    if (try_read_file(path, kMaxLibraryBytes, content)) return {};
    char text[32];
    std::snprintf(text, sizeof text, "%016llx-%zx", static_cast<unsigned long long>(hash_bytes(content.data(), content.size())),
                  content.size());
    return text;
}

// Names a version of a file without reading it.
std::string stamp_of(const std::string& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return {};
    return path + ' ' + std::to_string(status.st_size) + ' ' + std::to_string(status.st_ino) + ' ' +
           std::to_string(status.st_mtim.tv_sec) + '.' + std::to_string(status.st_mtim.tv_nsec);
}

fs::path folder() {
    const fs::path cache = cache_folder();
    return cache.empty() ? fs::path() : cache / "known_plugins";
}

std::mutex mutex;
std::set<std::string>& known() {
    static std::set<std::string>& stamps = *new std::set<std::string>;
    return stamps;
}

}  // namespace

Trust trust_of(const std::string& path) {
    const char* const wanted = std::getenv("CLARITY_PLUGINS");
    if (wanted && std::strcmp(wanted, "worker") == 0) return Trust::none;
    if (is_own_library(path)) return Trust::own;
    const std::lock_guard<std::mutex> lock(mutex);
    const std::string stamp = stamp_of(path);
    if (known().count(stamp)) return Trust::proven;
    std::error_code error;
    const fs::path file = folder();
    if (file.empty() || !fs::exists(file / hash_of(path), error)) return Trust::none;
    known().insert(stamp);
    return Trust::proven;
}

void remember_library(const std::string& path) {
    const std::lock_guard<std::mutex> lock(mutex);
    known().insert(stamp_of(path));
    // The note for later processes is a convenience: without it the next first build runs in a worker again.
    std::error_code error;
    const std::string hash = hash_of(path);
    if (folder().empty() || hash.empty()) return;
    fs::create_directories(folder(), error);
    std::ofstream(folder() / hash) << path << '\n';
}

}  // namespace clarity
