// process_folder.hpp -- a folder for temporary files which nothing of this process outlives, and a lock on a folder that stays.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

namespace clarity {

// Removes the folder at its end, and its parent if that is empty. If the process is killed, the next make() with the same
// parent and name removes it: the lock on its file `lock` is gone with the process.
class ProcessFolder {
 public:
    // PARENT/NAME-XXXXXX, which only this user can read. nullptr: there can be none, for example because PARENT cannot be
    // written.
    static std::unique_ptr<ProcessFolder> make(const std::filesystem::path& parent, const std::string& name);
    ~ProcessFolder();
    ProcessFolder(const ProcessFolder&) = delete;
    ProcessFolder& operator=(const ProcessFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

 private:
    ProcessFolder(std::filesystem::path path, int lock);
    const std::filesystem::path path_;
    const int lock_;     // descriptor
    const int process_;  // that made it: one that was forked from it leaves it alone
};

// While it is there, no other process has one for the same folder. Also a killed process gives it up.
class FolderLock {
 public:
    // Locks the file `lock` in the folder. nullptr: another process has it (errno is EWOULDBLOCK), or the file cannot be
    // written.
    static std::unique_ptr<FolderLock> take(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

 private:
    explicit FolderLock(int lock) : lock_(lock) {}
    const int lock_;  // descriptor
};

// For a process that is about to end by _exit(), also in a signal handler: starts a process that removes all its folders after
// that. Not before, because threads of a driver may still work in them: PoCL aborts if its folder is gone.
void leave_process_folders();

}  // namespace clarity
