#include "plugin/library_watch.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "base/error.hpp"
#include "base/files/cache_folder.hpp"
#include "base/files/library_files.hpp"
#include "base/files/process_folder.hpp"
#include "base/files/read_file.hpp"
#include "base/log.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr int kBetweenLooks_ms = 60;
constexpr int kLongestWrite_ms = 10000;  // a linker that takes longer ends with an event, and the library is looked at again
constexpr int kSecondChance_ms = 300;    // after a refusal: the file may be written in two goes

// A file as it is now. All zero: it is missing.
struct Look {
    dev_t device = 0;
    ino_t inode = 0;
    off_t bytes = 0;
    timespec modified{};
    bool operator==(const Look& other) const {
        return device == other.device && inode == other.inode && bytes == other.bytes &&
               modified.tv_sec == other.modified.tv_sec && modified.tv_nsec == other.modified.tv_nsec;
    }
    bool missing() const { return inode == 0; }
};

Look look_at(const std::string& path) {
    struct stat status{};
    if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
    return {status.st_dev, status.st_ino, status.st_size, status.st_mtim};
}

// True if a process is known to have the file open for writing, as a linker that maps its output. The kernel grants a read
// lease only where nobody has. File systems without leases grant none for another reason, which counts as no.
bool is_being_written(const std::string& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return false;
    fcntl(file, F_SETSIG, SIGURG);  // tells the holder of a lease of a new writer; ignored by default, as SIGIO is not
    const bool refused = fcntl(file, F_SETLEASE, F_RDLCK) != 0 && errno == EAGAIN;
    close(file);  // gives the lease back
    return refused;
}

// Copies a library to a new name: my_tree.2.so.
std::string private_copy(const std::string& path) {
    // Of this process. If it is killed, the next one that copies removes the folder.
    static const std::unique_ptr<ProcessFolder> folder = []() -> std::unique_ptr<ProcessFolder> {
        std::error_code error;
        const fs::path named = fs::temp_directory_path(error);
        const fs::path parent = fs::canonical(error ? fs::path("/tmp") : named, error);  // as the loader names its files
        const fs::path of_user = parent / ("clarity-plugins-" + std::to_string(geteuid()));
        return error || !make_own_folder(of_user) ? nullptr : ProcessFolder::make(of_user, "process");
    }();
    static std::atomic<unsigned> number{1};
    if (!folder)
        throw Error(Exit::failed, "no folder can be made for a copy of it; set TMPDIR to a folder with room, and start again");
    const fs::path copy = folder->path() / (fs::path(path).stem().string() + "." + std::to_string(++number) + ".so");
    std::error_code error;
    if (!fs::copy_file(path, copy, error))
        throw Error(Exit::failed, "cannot be copied to " + copy.string() + ": " + error.message() +
                                      "; set TMPDIR to a folder with room, and start again");
    note_private_copy(copy.string(), path);
    return copy.string();
}

std::string content_of(const std::string& path) {
    std::string content;
    return try_read_file(path, uint64_t{1} << 30, content) ? std::string() : content;
}

std::vector<std::string> paths_of(const PluginRegistry& plugins) {
    std::vector<std::string> paths;
    for (const PluginRecord& record : plugins.records()) paths.push_back(record.path);
    return paths;
}

}  // namespace

LibraryWatch::LibraryWatch(const PluginRegistry& plugins, std::function<void()> changed)
    : plugins_(plugins), changed_(std::move(changed)) {
    const std::lock_guard<std::mutex> lock(mutex_);  // load_changed() may run before files_ has its value
    files_ = std::make_unique<FileWatch>(paths_of(plugins), [this] { load_changed(); });
}

LibraryWatch::~LibraryWatch() {
    stop_ = true;
}

bool LibraryWatch::sleep(int milliseconds) const {
    for (int slept = 0; slept < milliseconds && !stop_; slept += 20) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return !stop_;
}

// Returns whether the file is there and nobody writes it any more.
bool LibraryWatch::wait_until_written(const std::string& path) const {
    for (int waited = 0; waited < kLongestWrite_ms; waited += kBetweenLooks_ms) {
        const Look before = look_at(path);
        if (!sleep(kBetweenLooks_ms)) return false;
        const Look after = look_at(path);
        if (after.missing()) return false;  // its return is an event
        if (before == after && !is_being_written(path)) return true;
    }
    return false;
}

// Loads the library of this path for apply(), unless it is what was loaded last. Returns false if it changed meanwhile.
bool LibraryWatch::load(const std::string& path) {
    if (!wait_until_written(path)) return true;
    const Look before = look_at(path);
    PluginRecord record;
    try {
        const std::string copy = private_copy(path);
        if (!(look_at(path) == before)) return false;
        std::string& last = last_copies_[path];
        if (!last.empty() && content_of(last) == content_of(copy)) return true;
        last = copy;
        record = load_plugin(copy);
        record.loaded = copy;
    } catch (const Error& error) {
        record.why = error.what();
    }
    if (!record.plugin && (!sleep(kSecondChance_ms) || !(look_at(path) == before))) return false;
    record.path = path;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        loaded_.push_back(std::move(record));
    }
    ++revision_;
    changed_();
    return true;
}

// Runs on the thread of the watch.
void LibraryWatch::load_changed() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
    }  // waits for the constructor
    for (const std::string& file : files_->last_changed())
        for (const PluginRecord& record : plugins_.records())
            if (fs::absolute(record.path).lexically_normal() == file)
                while (!stop_ && !load(record.path)) continue;
}

std::vector<RebuiltLibrary> LibraryWatch::apply() {
    std::vector<PluginRecord> loaded;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        loaded.swap(loaded_);
    }
    std::vector<RebuiltLibrary> results;
    for (const PluginRecord& record : loaded) {
        RebuiltLibrary result;
        result.path = record.path;
        bool was_there = false;
        for (const PluginRecord& old : plugins_.records())
            if (old.path == record.path) result.before = old.plugin, was_there = was_there || old.plugin;
        const Problem why = record.plugin ? plugins_.replace(record) : record.why;
        if (!why) {
            result.now = record.plugin;
            log(LogLevel::info, record.path + ": was built again and is in force now");
        } else {
            result.why = record.path + ": was built again and is refused: " + why.text() +
                         (was_there ? ". The build before it stays in force" : "");
        }
        results.push_back(std::move(result));
    }
    return results;
}

ParameterValues carried_parameters(const rt_plugin& before, const rt_plugin& now, const ParameterValues& values) {
    ParameterValues carried = default_parameters(now);
    for (rt_u32 i = 0; i < before.param_count && i < values.size(); ++i) {
        const std::string text = parameter_text(before, values, i);
        const size_t equals = text.find('=');
        try {
            set_parameter(now, carried, text.substr(0, equals), text.substr(equals + 1));
        } catch (const Error&) {
            // The parameter is gone, or its range has become smaller: the default holds.
        }
    }
    return carried;
}

}  // namespace clarity
