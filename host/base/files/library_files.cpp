#include "base/files/library_files.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <map>
#include <mutex>

namespace clarity {
namespace {

std::mutex mutex;
std::map<std::string, std::string>& copies() {
    static auto& all = *new std::map<std::string, std::string>;  // never freed: threads that outlive main() may still ask
    return all;
}

}  // namespace

std::filesystem::path program_file() {
    std::error_code error;
    const std::filesystem::path file = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path() : file;
}

std::string loaded_file_of(const void* address) {
    Dl_info info{};
    return dladdr(address, &info) != 0 && info.dli_fname ? info.dli_fname : "";
}

std::string library_of(const void* address) {
    const std::string file = loaded_file_of(address);
    std::error_code error;
    return file.empty() || std::filesystem::equivalent(file, program_file(), error) ? std::string() : file;
}

void note_private_copy(const std::string& copy, const std::string& original) {
    const std::lock_guard<std::mutex> lock(mutex);
    copies()[copy] = std::filesystem::absolute(original).lexically_normal().string();
}

std::string original_of(const std::string& loaded) {
    if (loaded.empty()) return {};
    const std::lock_guard<std::mutex> lock(mutex);
    const auto found = copies().find(loaded);
    return found != copies().end() ? found->second : std::filesystem::absolute(loaded).lexically_normal().string();
}

}  // namespace clarity
