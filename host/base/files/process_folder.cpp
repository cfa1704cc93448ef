#include "base/files/process_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>

#include "base/files/cache_folder.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr const char *kLock = "lock", *kNewLock = "new-lock";
constexpr int kMostTries = 100;

// The paths of all folders, for a signal handler.
constexpr size_t kMostFolders = 4;
std::atomic<const char*> folders_of_process[kMostFolders];
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler may touch nothing that locks");

// Locks the file, and makes it if that is asked for. Returns its descriptor; -1: another process has it, or it is not there, as
// errno says.
int locked(const fs::path& file, int flags) {
    const int fd = open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | flags, 0600);
    if (fd < 0 || flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
    const int why = errno;
    close(fd);
    errno = why;
    return -1;
}

// PARENT/NAME-XXXXXX; empty: it cannot be made.
std::string made_below(const fs::path& parent, const std::string& name) {
    for (int i = 0; i < kMostTries; ++i) {
        std::error_code ignored;
        fs::create_directories(parent, ignored);
        std::string path = (parent / (name + "-XXXXXX")).string();
        if (mkdtemp(path.data())) return path;
        if (errno != ENOENT) break;  // else a process that ended has just removed the parent
    }
    return {};
}

// Removes a folder if its process has ended.
void remove_if_left(const fs::path& folder) {
    if (!is_own_folder(folder)) return;
    std::error_code error;
    const int lock = locked(folder / kLock, 0);
    // A folder without the file may just be in the making.
    const bool is_old = fs::file_time_type::clock::now() - fs::last_write_time(folder, error) > std::chrono::minutes(1);
    const bool is_left = lock >= 0 || (!fs::exists(folder / kLock, error) && !error && is_old);
    if (is_left) fs::remove_all(folder, error);
    if (lock >= 0) close(lock);
}

}  // namespace

std::unique_ptr<ProcessFolder> ProcessFolder::make(const fs::path& parent, const std::string& name) {
    std::error_code error;
    for (fs::directory_iterator at(parent, error), end; !error && at != end; at.increment(error))
        if (at->path().filename().string().compare(0, name.size() + 1, name + "-") == 0) remove_if_left(at->path());
    const std::string path = made_below(parent, name);
    if (path.empty()) return nullptr;
    // The file gets its name when it is locked, so that no other process can lock it first.
    const int lock = locked(fs::path(path) / kNewLock, O_CREAT);
    if (lock >= 0) {
        fs::rename(fs::path(path) / kNewLock, fs::path(path) / kLock, error);
        if (!error) return std::unique_ptr<ProcessFolder>(new ProcessFolder(path, lock));
        close(lock);
    }
    fs::remove_all(path, error);
    return nullptr;
}

ProcessFolder::ProcessFolder(fs::path path, int lock) : path_(std::move(path)), lock_(lock), process_(getpid()) {
    for (auto& folder : folders_of_process) {
        const char* none = nullptr;
        if (folder.compare_exchange_strong(none, path_.c_str())) return;
    }
}

ProcessFolder::~ProcessFolder() {
    if (getpid() != process_) return;
    for (auto& folder : folders_of_process) {
        const char* own = path_.c_str();
        folder.compare_exchange_strong(own, nullptr);
    }
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    rmdir(path_.parent_path().c_str());  // fails if others have folders there
    close(lock_);
}

std::unique_ptr<FolderLock> FolderLock::take(const fs::path& folder) {
    const int lock = locked(folder / kLock, O_CREAT);
    return lock < 0 ? nullptr : std::unique_ptr<FolderLock>(new FolderLock(lock));
}

FolderLock::~FolderLock() {
    close(lock_);
}

void leave_process_folders() {
    // It reads until this process has ended, because the pipe is closed then. It ignores a second Ctrl+C.
    constexpr const char* kScript = "trap '' INT TERM HUP; read -r nothing; rm -rf -- \"$0\"; rmdir -- \"${0%/*}\" 2>/dev/null";
    for (auto& folder : folders_of_process) {
        const char* const path = folder;
        int ends[2];
        if (!path || pipe2(ends, O_CLOEXEC) != 0) continue;
        // vfork(), because a copy of a large process takes long.
        if (vfork() == 0) {
            // Its input stays open, also where the pipe itself has that number.
            if (dup2(ends[0], STDIN_FILENO) == STDIN_FILENO && fcntl(STDIN_FILENO, F_SETFD, 0) == 0)
                execl("/bin/sh", "sh", "-c", kScript, path, static_cast<char*>(nullptr));
            _exit(1);
        }
        close(ends[0]);  // ends[1] stays open
    }
}

}  // namespace clarity
