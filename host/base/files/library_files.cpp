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

std::filesystem::path& named_program() {
    static auto& file = *new std::filesystem::path;
    return file;
}

}  // namespace

void set_program_file(const std::filesystem::path& file) {
    const std::lock_guard<std::mutex> lock(mutex);
    named_program() = file;
}

bool is_library() {
    const std::lock_guard<std::mutex> lock(mutex);
    return !named_program().empty();
}

std::filesystem::path program_file() {
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!named_program().empty()) return named_program();
    }
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
    return file == loaded_file_of(reinterpret_cast<const void*>(&library_of)) ? std::string() : file;
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
