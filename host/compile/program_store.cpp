#include "compile/program_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/files/cache_folder.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/log.hpp"
#include "device/pocl_cache.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostProgramBytes = uint64_t{64} << 20;
constexpr const char *kSuffix = ".program", *kAside = ".aside";
constexpr uint64_t kLeastFileBytes = 4096;  // what even an empty file takes on a disk

// The beginning of a file; its binary follows.
struct StoredHead {
    char magic[8];
    uint64_t bytes;     // of the binary
    uint64_t checksum;  // of the binary and the key
};
constexpr char kStoredMagic[8] = {'C', 'l', 'a', 'r', 'P', 'r', 'g', '2'};

uint64_t checksum_of(const std::string& key, const char* binary, size_t bytes) {
    return hash_bytes(binary, bytes, hash_bytes(key.data(), key.size()));
}

// Where there is none, programs are kept as long as the process lives, beside what PoCL has unpacked of them.
fs::path folder_of_process() {
    return has_own_pocl_cache() ? fs::path(pocl_cache()) / "programs" : fs::path();
}

fs::path store_folder() {
    const char* named = std::getenv("CLARITY_PROGRAM_CACHE");
    if (named && std::strcmp(named, "off") == 0) return folder_of_process();
    if (named && *named) return named;
    const fs::path cache = cache_folder();
    return cache.empty() ? folder_of_process() : cache / "programs";
}

fs::path stored_file(const std::string& key, const char* suffix = kSuffix) {
    const fs::path folder = store_folder();
    return folder.empty() ? fs::path() : folder / (key + suffix);
}

// Removes what was used least recently, so that three quarters of the room are in use.
void make_room(const fs::path& folder, uint64_t most_bytes) {
    struct Stored {
        fs::path path;
        uint64_t bytes;
        fs::file_time_type used;
    };
    std::vector<Stored> files;
    uint64_t sum = 0;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        std::error_code gone;  // another process may remove it meanwhile
        Stored file{at->path(), at->file_size(gone), at->last_write_time(gone)};
        if (gone || (file.path.extension() != kSuffix && file.path.extension() != kAside)) continue;
        sum += file.bytes = std::max(file.bytes, kLeastFileBytes);
        files.push_back(std::move(file));
    }
    if (sum <= most_bytes) return;
    std::sort(files.begin(), files.end(), [](const Stored& a, const Stored& b) { return a.used < b.used; });
    for (const Stored& file : files) {
        if (sum <= most_bytes / 4 * 3) return;
        fs::remove(file.path, error);
        sum -= file.bytes;
    }
}

}  // namespace

std::string program_key(const DeviceInfo& info, const std::string& source, const std::string& options) {
    std::string text;
    const std::string device = info.name_of_whole();
    for (const std::string* part : {&info.platform, &info.vendor, &device, &info.version, &info.driver, &options, &source})
        text += std::to_string(part->size()) + ":" + *part;
    // Variables of PoCL that change its code.
    for (const char* name :
         {"POCL_EXTRA_BUILD_FLAGS", "POCL_WORK_GROUP_METHOD", "POCL_VECTORIZER_REMARKS", "POCL_DEBUG_LLVM_PASSES"})
        if (const char* value = info.pocl ? std::getenv(name) : nullptr) text += std::string(name) + "=" + value + "\n";
    // Two hashes, so that no two programs ever meet.
    char name[40];
    std::snprintf(name, sizeof name, "%016llx%016llx", static_cast<unsigned long long>(hash_bytes(text.data(), text.size())),
                  static_cast<unsigned long long>(hash_bytes(text.data(), text.size(), hash_bytes("second", 6))));
    return name;
}

bool keeps_programs() {
    return !store_folder().empty();
}

std::optional<std::vector<char>> find_program(const std::string& key) {
    const fs::path path = stored_file(key);
    std::string content;
    std::error_code error;
    if (path.empty() || !fs::exists(path, error)) return std::nullopt;
    StoredHead head{};
    if (try_read_file(path.string(), kMostProgramBytes + sizeof head, content)) return std::nullopt;
    const char* binary = content.data() + sizeof head;
    if (content.size() >= sizeof head) std::memcpy(&head, content.data(), sizeof head);
    if (std::memcmp(head.magic, kStoredMagic, sizeof kStoredMagic) != 0 || head.bytes != content.size() - sizeof head ||
        head.checksum != checksum_of(key, binary, head.bytes)) {
        log(LogLevel::debug, path.string() + ": is damaged, and compiled again");
        fs::remove(path, error);
        return std::nullopt;
    }
    utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // used now
    return std::vector<char>(binary, binary + head.bytes);
}

void keep_program(const std::string& key, const std::vector<char>& binary, uint64_t most_bytes) {
    const fs::path path = stored_file(key);
    if (path.empty() || binary.size() > kMostProgramBytes) return;
    try {
        fs::create_directories(path.parent_path());
        StoredHead head{};
        std::memcpy(head.magic, kStoredMagic, sizeof kStoredMagic);
        head.bytes = binary.size();
        head.checksum = checksum_of(key, binary.data(), binary.size());
        OutputFile file(path.string());
        file.write(&head, sizeof head);
        file.write(binary.data(), binary.size());
        file.commit();
        make_room(path.parent_path(), most_bytes);
    } catch (const std::exception& e) {  // programs are compiled again then
        log(LogLevel::debug, std::string("a compiled program is not kept: ") + e.what());
    }
}

void forget_program(const std::string& key) {
    std::error_code error;
    if (const fs::path path = stored_file(key); !path.empty()) fs::remove(path, error);
}

void set_aside(const std::string& key) {
    std::error_code error;
    if (keeps_programs()) fs::rename(stored_file(key), stored_file(key, kAside), error);
}

void put_back(const std::string& key) {
    std::error_code error;
    if (keeps_programs()) fs::rename(stored_file(key, kAside), stored_file(key), error);
}

}  // namespace clarity
