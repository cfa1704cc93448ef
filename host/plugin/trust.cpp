#include "plugin/trust.hpp"

#include <dlfcn.h>
#include <sys/stat.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>

#include "base/files/cache_folder.hpp"
#include "base/files/read_file.hpp"
#include "plugin/registry.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

constexpr uint64_t kMaxLibraryBytes = uint64_t{1} << 30;

// Libraries of which a build has come to its end, by their content.
KnownContents& proven_libraries() {
    static auto& libraries = *new KnownContents("known_plugins");
    return libraries;
}

// Empty: the file cannot be read.
std::string name_of_content(const std::string& path) {
    std::string content;
    return try_read_file(path, kMaxLibraryBytes, content) ? std::string() : KnownContents::name_of(content);
}

// Names a version of a file without reading it.
std::string stamp_of(const std::string& path) {
    struct stat status{};
    if (stat(path.c_str(), &status) != 0) return {};
    return path + ' ' + std::to_string(status.st_size) + ' ' + std::to_string(status.st_ino) + ' ' +
           std::to_string(status.st_mtim.tv_sec) + '.' + std::to_string(status.st_mtim.tv_nsec);
}

std::atomic<bool> own_only{false};

// Versions of files that were found proven, so that they are read once.
std::mutex mutex;
std::set<std::string>& known() {
    static std::set<std::string>& stamps = *new std::set<std::string>;
    return stamps;
}

constexpr const char* kAdvice = "; the file may be damaged: build it or copy it again";

void load(ParcelReader& arguments) {
    const auto library = worker::arguments_in<std::string>(arguments);
    load_plugin(library);  // the parent finds out itself why a library is refused
    // Its destructors would run at the end of the program.
    const std::string full = std::filesystem::absolute(library).string();
    if (void* const handle = dlopen(full.c_str(), RTLD_NOW | RTLD_NOLOAD)) {
        dlclose(handle);
        dlclose(handle);  // what load_plugin() holds
    }
}

}  // namespace

Trust trust_of(const std::string& path) {
    const char* const wanted = std::getenv("CLARITY_PLUGINS");
    if (wanted && std::strcmp(wanted, "worker") == 0) return Trust::none;
    if (is_own_library(path)) return Trust::own;
    if (own_only) return Trust::none;
    const std::lock_guard<std::mutex> lock(mutex);
    const std::string stamp = stamp_of(path);
    if (known().count(stamp)) return Trust::proven;
    const std::string name = name_of_content(path);
    if (name.empty() || !proven_libraries().has(name)) return Trust::none;
    known().insert(stamp);
    return Trust::proven;
}

void trust_own_libraries_only() {
    own_only = true;
}

void remember_library(const std::string& path) {
    const std::lock_guard<std::mutex> lock(mutex);
    known().insert(stamp_of(path));
    if (const std::string name = name_of_content(path); !name.empty()) proven_libraries().add(name, path);
}

const worker::JobKind kLoadJob = {
    "load",
    "to look at a plugin, run `clarity plugins --plugin FILE`",
    Exit::failed,
    true,
    LogLevel::debug,
    {"crashed the process that opened it ({how}){advice}", "ended the process that opened it ({how}){advice}",
     "did not let the process that opened it go on for {how}{advice}", "was being opened when that process was killed{advice}",
     "took more than {how} of memory when it was opened{advice}", "was being opened when that process was killed{advice}"},
    load};

Problem try_to_load(const std::string& path) {
    if (worker::in_worker() || trust_of(path) != Trust::none) return {};
    worker::Job job(kLoadJob, "a library that was opened", {10, 0, uint64_t(4) << 30});
    job.advice = kAdvice;
    job.subject = path;
    try {
        Progress progress;
        job.run(path, progress);
    } catch (const worker::JobDied& died) {
        return died.what();
    } catch (const std::exception& e) {
        log(LogLevel::debug, path + ": is opened without a trial: " + e.what());
    }
    return {};
}

}  // namespace clarity
