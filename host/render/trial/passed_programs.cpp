#include "render/trial/passed_programs.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>

#include "base/files/cache_folder.hpp"
#include "base/hash.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
    return cache_folder() / "tried_kernels";
}

struct Names {
    std::mutex mutex;
    std::set<std::string> all;
};
Names& names() {
    static auto& one = *new Names;
    return one;
}

}  // namespace

PassedProgram::PassedProgram(const std::string& text) {
    char name[40];
    std::snprintf(name, sizeof name, "%016llx-%zx", static_cast<unsigned long long>(hash_bytes(text.data(), text.size())),
                  text.size());
    name_ = name;
}

bool PassedProgram::known() const {
    const std::lock_guard<std::mutex> lock(names().mutex);
    std::error_code error;
    return names().all.count(name_) || (!cache_folder().empty() && fs::exists(folder() / name_, error));
}

void PassedProgram::keep() const {
    const std::lock_guard<std::mutex> lock(names().mutex);
    names().all.insert(name_);
    // The note for later processes is a convenience: without it they try these kernels again.
    if (cache_folder().empty()) return;
    std::error_code error;
    fs::create_directories(folder(), error);
    std::ofstream(folder() / name_) << '\n';
}

}  // namespace clarity
