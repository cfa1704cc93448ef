#include "base/files/file_watch.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "base/digest.hpp"

namespace clarity {
namespace {

constexpr int kLookEvery_ms = 500;     // looking at 40 files takes 40 calls of stat, about 50 us
constexpr int kQuiet_ms = 50;          // a burst of events is over after this time without an event
constexpr int kQuietOfLarge_ms = 100;  // a program that writes a large file computes in between
constexpr int kLongestBurst_ms = 1000;
constexpr uint64_t kLarge_bytes = 1 << 20;

// IN_MODIFY is left out: it comes while a file is still being written.
constexpr uint32_t kEvents =
    IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_CREATE | IN_DELETE | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;

// Hash of a file's content; 0 if it cannot be read. It only has to tell one save from the next, not to resist
// an attacker.
uint64_t hash_of(const std::string& path) {
    uint64_t hash = hash_bytes(nullptr, 0);
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return 0;
    char buffer[1 << 16];
    ssize_t got;
    while ((got = read(file, buffer, sizeof buffer)) > 0 || (got < 0 && errno == EINTR))
        if (got > 0) hash = hash_bytes(buffer, static_cast<size_t>(got), hash);
    close(file);
    return hash;
}

std::vector<std::string> absolute(std::vector<std::string> paths) {
    for (std::string& path : paths) path = std::filesystem::absolute(path).lexically_normal().string();
    std::sort(paths.begin(), paths.end());
    paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
    return paths;
}

}  // namespace

bool FileWatch::State::same_file(const State& other) const {
    return device == other.device && inode == other.inode && bytes == other.bytes && modified_ns == other.modified_ns;
}

// Reads the state of a file without its hash.
FileWatch::State FileWatch::look(const std::string& path) {
    struct stat status{};
    State state;
    if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return state;
    state.device = status.st_dev;
    state.inode = status.st_ino;
    state.bytes = static_cast<uint64_t>(status.st_size);
    state.modified_ns = int64_t(status.st_mtim.tv_sec) * 1000000000 + status.st_mtim.tv_nsec;
    return state;
}

FileWatch::FileWatch(std::vector<std::string> files, std::function<void()> changed, Rule rule)
    : paths_(absolute(std::move(files))), changed_(std::move(changed)), rule_(rule) {
    for (const std::string& path : paths_) {
        std::string folder = std::filesystem::path(path).parent_path().string();
        if (std::find(folders_.begin(), folders_.end(), folder) == folders_.end()) folders_.push_back(std::move(folder));
        State state = look(path);
        if (state.inode && rule_ == Rule::content) state.hash = hash_of(path);
        states_.push_back(state);
    }
    watches_.assign(folders_.size(), -1);
    stop_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (stop_ < 0) throw std::system_error(errno, std::generic_category(), "watching files for changes: no eventfd");
    inotify_ = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);  // may fail; then only file times are compared
    add_folders();
    thread_ = std::thread([this] { run(); });
}

FileWatch::~FileWatch() {
    const uint64_t one = 1;
    if (write(stop_, &one, sizeof one) < 0) std::terminate();  // cannot fail on a new eventfd
    thread_.join();
    close(stop_);
    if (inotify_ >= 0) close(inotify_);
}

std::vector<std::string> FileWatch::last_changed() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_changed_;
}

void FileWatch::add_folders() {
    bool all = inotify_ >= 0;
    for (size_t i = 0; i < folders_.size() && inotify_ >= 0; ++i) {
        if (watches_[i] >= 0) continue;
        watches_[i] = inotify_add_watch(inotify_, folders_[i].c_str(), kEvents);
        all = all && (watches_[i] >= 0 || errno == ENOENT || errno == ENOTDIR);
    }
    prompt_ = all;
}

// Reads all pending events; returns false if there was none. A folder that was removed is watched again once it is back.
bool FileWatch::drain() {
    alignas(inotify_event) char buffer[4096];
    bool any = false;
    for (ssize_t got; inotify_ >= 0 && (got = read(inotify_, buffer, sizeof buffer)) > 0;) {
        any = true;
        for (ssize_t at = 0; at < got;) {
            const auto* event = reinterpret_cast<const inotify_event*>(buffer + at);
            at += static_cast<ssize_t>(sizeof *event + event->len);
            if (event->mask & IN_MOVE_SELF) inotify_rm_watch(inotify_, event->wd);  // IN_IGNORED follows
            if (event->mask & IN_IGNORED) std::replace(watches_.begin(), watches_.end(), event->wd, -1);
        }
    }
    return any;
}

bool FileWatch::times_differ() const {
    for (size_t i = 0; i < paths_.size(); ++i)
        if (!look(paths_[i]).same_file(states_[i])) return true;
    return false;
}

// Whether a file is missing that was there.
bool FileWatch::lacks_one() const {
    for (size_t i = 0; i < paths_.size(); ++i)
        if (states_[i].inode && !look(paths_[i]).inode) return true;
    return false;
}

// Waits for the end of a burst: an editor may save several files at once, or remove, write and rename one. A large file may be
// written for minutes.
void FileWatch::settle() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kLongestBurst_ms);
    const auto look_at_all = [this] {
        std::vector<State> all;
        for (const std::string& path : paths_) all.push_back(look(path));
        return all;
    };
    pollfd waits[2] = {{stop_, POLLIN, 0}, {inotify_, POLLIN, 0}};
    for (std::vector<State> before = look_at_all(); rule_ == Rule::times || std::chrono::steady_clock::now() < end;) {
        const int ready = poll(waits, 2, rule_ == Rule::times ? kQuietOfLarge_ms : kQuiet_ms);
        if (waits[0].revents) return;
        std::vector<State> now = look_at_all();
        const bool same =
            std::equal(now.begin(), now.end(), before.begin(), [](const State& a, const State& b) { return a.same_file(b); });
        if (ready == 0 && same && (rule_ == Rule::content || !lacks_one())) return;
        before = std::move(now);
        drain();
    }
}

void FileWatch::compare() {
    std::vector<std::string> differ;
    for (size_t i = 0; i < paths_.size(); ++i) {
        State now = look(paths_[i]);
        if (rule_ == Rule::times && now.inode && !now.same_file(states_[i])) differ.push_back(paths_[i]);
        // Times are not enough for small files: two saves within one tick of the file system's clock look alike. A large
        // file takes longer than a tick to write, so it is read again only if its times have changed.
        const bool known = now.same_file(states_[i]) && now.bytes > kLarge_bytes;
        if (rule_ == Rule::content) now.hash = known ? states_[i].hash : now.inode ? hash_of(paths_[i]) : 0;
        if (now.hash != states_[i].hash) differ.push_back(paths_[i]);
        states_[i] = now;
    }
    if (differ.empty()) return;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        last_changed_ = std::move(differ);
    }
    ++revision_;
    if (changed_) changed_();
}

void FileWatch::run() {
    pollfd waits[2] = {{stop_, POLLIN, 0}, {inotify_, POLLIN, 0}};  // poll ignores a negative descriptor
    for (;;) {
        poll(waits, 2, kLookEvery_ms);
        if (waits[0].revents) return;
        const bool told = drain();
        add_folders();
        if (!told && !times_differ()) continue;
        settle();
        compare();
    }
}

}  // namespace clarity
