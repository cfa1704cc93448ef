#include "device/pocl_cache.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "base/files/cache_folder.hpp"
#include "base/files/process_folder.hpp"
#include "base/problem.hpp"
#include "worker/channel.hpp"

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
Problem why_unwritable(const fs::path& folder) {
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
    // PoCL loads what it has compiled as libraries.
    void* const code = why.empty() ? mmap(nullptr, 1, PROT_READ | PROT_EXEC, MAP_PRIVATE, file, 0) : MAP_FAILED;
    if (why.empty() && code == MAP_FAILED) why = std::string("code in it cannot be run: ") + std::strerror(errno);
    if (code != MAP_FAILED) munmap(code, 1);
    close(file);
    return why;
}

// Below the folders that others may write to, too.
fs::path folder_of_user(const fs::path& parent) {
    return parent / ("clarity-pocl-" + std::to_string(geteuid()));
}

fs::path temporary_folder() {
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    return error ? fs::path() : folder_of_user(folder);
}

fs::path folder_in_cache() {
    const fs::path cache = cache_folder();
    return cache.empty() ? fs::path() : cache / "pocl";
}

// Removed at the end of the process.
std::unique_ptr<ProcessFolder>& own_folder() {
    static std::unique_ptr<ProcessFolder> folder;
    return folder;
}

bool take_own_folder() {
    const char* named = std::getenv("POCL_CACHE_DIR");
    const fs::path candidates[] = {named && *named ? folder_of_user(named) : fs::path(), temporary_folder(), folder_in_cache()};
    for (const fs::path& parent : candidates) {
        if (parent.empty() || !make_own_folder(parent) || why_unwritable(parent)) continue;
        own_folder() = ProcessFolder::make(parent, "process");
        if (!own_folder()) continue;
        setenv("POCL_CACHE_DIR", own_folder()->path().c_str(), 1);
        return true;
    }
    return false;
}

std::string use_writable_folder() {
    const fs::path folder = pocl_folder();
    if (folder.empty()) return {};
    const Problem why = why_unwritable(folder);
    if (!why) return {};
    const std::string what = "PoCL's cache " + folder.string() + " cannot be written: " + why.text();
    for (const fs::path& other : {folder_in_cache(), temporary_folder()}) {
        if (other.empty() || !make_own_folder(other) || why_unwritable(other)) continue;
        setenv("POCL_CACHE_DIR", other.c_str(), 1);
        return what + "; " + other.string() + " is used instead";
    }
    return what + ", and no other folder either, so that nothing can be compiled: set POCL_CACHE_DIR to a folder with room";
}

}  // namespace

bool compiles_in_worker() {
    if (worker::in_worker()) return false;
    const char* place = std::getenv("CLARITY_COMPILE");
    return !place || std::strcmp(place, "here") != 0;
}

std::string pocl_cache() {
    return pocl_folder().string();
}

bool has_own_pocl_cache() {
    return own_folder() != nullptr;
}

std::string prepare_pocl_cache() {
    if (compiles_in_worker() && take_own_folder()) return {};
    return use_writable_folder();
}

}  // namespace clarity
