// Layout of an entry in the store: kMagic, then for each file the lengths of its name and its content (8 bytes each), the name,
// relative to the cache folder, and the content.
#include "compile/program_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <list>
#include <mutex>

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
constexpr char kStoredMagic[8] = {'C', 'l', 'a', 'r', 'P', 'r', 'g', '1'};

uint64_t checksum_of(const std::string& key, const char* binary, size_t bytes) {
    return hash_bytes(binary, bytes, hash_bytes(key.data(), key.size()));
}

fs::path store_folder() {
    const char* named = std::getenv("CLARITY_PROGRAM_CACHE");
    if (named && std::strcmp(named, "off") == 0) return {};
    if (named && *named) return named;
    const fs::path cache = cache_folder();
    return cache.empty() ? fs::path() : cache / "programs";
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

namespace fs = std::filesystem;

constexpr char kMagic[8] = {'C', 'l', 'P', 'o', 'c', 'l', 'E', '1'};
constexpr size_t kMostKept = 16;  // editing kernels makes hundreds of programs; the last ones are of use

void put_number(std::vector<char>& bytes, uint64_t number) {
    const char* const at = reinterpret_cast<const char*>(&number);
    bytes.insert(bytes.end(), at, at + sizeof number);
}

struct Entry {
    std::string key;
    fs::path name;     // XX/NAME
    size_t known = 0;  // files that the store has
};

size_t count_files(const fs::path& folder) {
    std::error_code error;
    size_t count = 0;
    for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        count += at->is_regular_file(error);
    return count;
}

std::vector<char> packed(const fs::path& cache, const fs::path& name) {
    std::vector<char> bytes(kMagic, kMagic + sizeof kMagic);
    std::error_code error;
    for (fs::recursive_directory_iterator at(cache / name, error), end; !error && at != end; at.increment(error)) {
        if (!at->is_regular_file(error)) continue;
        std::ifstream file(at->path(), std::ios::binary);
        const std::string content{std::istreambuf_iterator<char>(file), {}};
        const std::string path = at->path().lexically_relative(cache).string();
        put_number(bytes, path.size());
        put_number(bytes, content.size());
        bytes.insert(bytes.end(), path.begin(), path.end());
        bytes.insert(bytes.end(), content.begin(), content.end());
    }
    return error ? std::vector<char>() : bytes;
}

// The entries of this process; the latest one last.
class Entries {
 public:
    // The store gets what is new.
    ~Entries() {
        const fs::path cache = pocl_cache();
        for (const Entry& entry : all_) {
            if (count_files(cache / entry.name) == entry.known) continue;
            const std::vector<char> bytes = packed(cache, entry.name);
            if (!bytes.empty()) keep_program(entry.key, bytes);
        }
    }
    void add(Entry entry) {
        const std::lock_guard<std::mutex> lock(mutex_);
        all_.remove_if([&](const Entry& other) { return other.key == entry.key; });
        all_.push_back(std::move(entry));
        if (all_.size() > kMostKept) all_.pop_front();
    }
    bool has(const std::string& key) {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (const Entry& entry : all_)
            if (entry.key == key) return true;
        return false;
    }
    unsigned next_number() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return number_++;
    }

 private:
    std::mutex mutex_;
    std::list<Entry> all_;
    unsigned number_ = 0;
};

// Made after the folder of the cache, so that it ends before that is removed.
Entries& entries() {
    static Entries all;
    return all;
}

// A name that leads nowhere else.
bool is_below(const fs::path& name) {
    if (name.empty() || name.is_absolute()) return false;
    for (const fs::path& part : name)
        if (part == "..") return false;
    return true;
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

std::string folder_for_worker() {
    if (!has_own_pocl_cache()) return {};
    return (fs::path(pocl_cache()) / ("worker-" + std::to_string(entries().next_number()))).string();
}

void drop_folder(const std::string& folder) {
    std::error_code ignored;
    if (!folder.empty()) fs::remove_all(folder, ignored);
}

void take_entry(const std::string& key, const std::string& folder) {
    if (folder.empty()) return;
    const fs::path cache = pocl_cache();
    std::error_code error;
    for (fs::directory_iterator group(folder, error), end; !error && group != end; group.increment(error)) {
        if (!group->is_directory(error)) continue;
        for (fs::directory_iterator program(group->path(), error); !error && program != end; program.increment(error)) {
            const fs::path name = group->path().filename() / program->path().filename();
            fs::create_directories(cache / name.parent_path(), error);
            fs::rename(program->path(), cache / name, error);  // fails if there is one already, which serves as well
            if (fs::exists(cache / name / "program.bc", error)) entries().add({key, name});
            error.clear();
        }
    }
    drop_folder(folder);
}

bool has_entry(const std::string& key) {
    return has_own_pocl_cache() && entries().has(key);
}

bool unpack_entry(const std::string& key, const std::vector<char>& stored) {
    if (!has_own_pocl_cache() || stored.size() < sizeof kMagic || std::memcmp(stored.data(), kMagic, sizeof kMagic) != 0)
        return false;
    const fs::path cache = pocl_cache();
    Entry entry{key, {}};
    for (size_t at = sizeof kMagic; at < stored.size();) {
        uint64_t lengths[2];
        if (stored.size() - at < sizeof lengths) return false;
        std::memcpy(lengths, &stored[at], sizeof lengths);
        at += sizeof lengths;
        if (lengths[0] > stored.size() - at || lengths[1] > stored.size() - at - lengths[0]) return false;
        const fs::path name = std::string(&stored[at], lengths[0]);
        at += lengths[0];
        if (!is_below(name) || std::distance(name.begin(), name.end()) < 3) return false;
        entry.name = *name.begin() / *std::next(name.begin());
        std::error_code error;
        fs::create_directories((cache / name).parent_path(), error);
        std::ofstream file(cache / name, std::ios::binary);
        file.write(stored.data() + at, static_cast<std::streamsize>(lengths[1]));
        if (!file.flush()) return false;
        at += lengths[1];
        ++entry.known;
    }
    entries().add(std::move(entry));
    return true;
}

}  // namespace clarity
