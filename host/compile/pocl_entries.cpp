// Layout of an entry in the store: kMagic, then for each file the lengths of its name and its content (8 bytes each), the name,
// relative to the cache folder, and the content.
#include "compile/pocl_entries.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <list>
#include <mutex>

#include "compile/program_store.hpp"
#include "device/pocl_cache.hpp"

namespace clarity {
namespace {

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
