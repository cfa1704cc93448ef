#include "base/files/output_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <mutex>
#include <set>

#include "base/error.hpp"
#include "base/machine.hpp"
#include "base/problem.hpp"

namespace clarity {
namespace {

bool is_stream(const std::string& path) {
    struct stat status{};
    return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

// A link stays a link: the file that it leads to is replaced. Returns the path of that file.
std::string follow_links(const std::string& path) {
    char* real = realpath(path.c_str(), nullptr);
    if (!real) return path;
    std::string result = real;
    std::free(real);
    return result;
}

std::string folder_of(const std::string& path) {
    const size_t slash = path.rfind('/');
    return slash == std::string::npos ? "./" : path.substr(0, slash + 1);
}

// The path by which linkat() or another process reaches an open file that has no name.
std::string descriptor_path(int file) {
    return "/proc/self/fd/" + std::to_string(file);
}

// ".clarity-HOST-PID-START-N.tmp": the dot hides the file, and the program's name explains where a file that was left by a
// power cut comes from. START, seconds since 1970, keeps processes apart that get one number after each other.
std::string temporary_prefix() {
    return ".clarity-" + host_name() + "-";
}
constexpr const char* kSuffix = ".tmp";
std::string next_temporary_name(const std::string& folder) {
    static std::atomic<unsigned> number{0};
    static const long start = static_cast<long>(time(nullptr));
    return folder + temporary_prefix() + std::to_string(getpid()) + "-" + std::to_string(start) + "-" +
           std::to_string(number++) + kSuffix;
}
// Three numbers between prefix and suffix: the name of another host may begin like this one's.
bool is_temporary_name(const std::string& name) {
    const std::string prefix = temporary_prefix();
    const size_t suffix = std::strlen(kSuffix);
    if (name.size() <= prefix.size() + suffix || name.compare(0, prefix.size(), prefix) != 0 ||
        name.compare(name.size() - suffix, suffix, kSuffix) != 0)
        return false;
    const std::string numbers = name.substr(prefix.size(), name.size() - prefix.size() - suffix);
    return numbers.find_first_not_of("0123456789-") == std::string::npos &&
           std::count(numbers.begin(), numbers.end(), '-') == 2;
}

// Removes temporary files of this host's killed processes from `folder`. A running writer holds a lock on its file, which the
// system releases when the process ends. Files of other hosts stay: some shared file systems have locks that only one host
// sees. Failures are ignored: the next write tries again.
void remove_leftovers(const std::string& folder) {
    const std::unique_ptr<DIR, int (*)(DIR*)> all(opendir(folder.c_str()), closedir);
    if (!all) return;
    while (const dirent* entry = readdir(all.get())) {
        if (!is_temporary_name(entry->d_name)) continue;
        const int file = openat(dirfd(all.get()), entry->d_name, O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
        if (file < 0) continue;
        if (flock(file, LOCK_EX | LOCK_NB) == 0) unlinkat(dirfd(all.get()), entry->d_name, 0);
        ::close(file);
    }
}

// Only once per folder: a sequence of pictures would otherwise list its growing folder for every picture.
void remove_leftovers_once(const std::string& folder) {
    static std::mutex& mutex = *new std::mutex;
    static std::set<std::string>& done = *new std::set<std::string>;
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!done.insert(folder).second) return;
    }
    remove_leftovers(folder);
}

// Opens a new file in `folder`; returns -1 and sets errno if that fails. Normally the file has no name, and `name` stays empty:
// the file vanishes with its writer. Some file systems (NFS, FAT) do not support that; then `name` is the temporary name.
int create_temporary(const std::string& folder, std::string& name) {
    name.clear();
    const int nameless = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (nameless >= 0) {
        if (access(descriptor_path(nameless).c_str(), F_OK) == 0) return nameless;
        ::close(nameless);  // /proc is not mounted, so the file could never get a name
    }
    for (;;) {
        name = next_temporary_name(folder);
        const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file < 0 && errno == EEXIST) continue;
        if (file < 0) return -1;
        // Another process may have taken the file for a leftover before it was locked. Then wait until that process has removed
        // it.
        while (flock(file, LOCK_EX) != 0 && errno == EINTR) {
        }
        struct stat status{};
        if (fstat(file, &status) == 0 && status.st_nlink > 0) return file;
        ::close(file);
    }
}

// Finds what rename() would refuse before any work is done. Returns nothing if nothing is wrong.
Problem why_not_writable(const std::string& path) {
    if (path.empty()) return "the name is empty";
    struct stat status{};
    if (stat(path.c_str(), &status) == 0) {
        if (S_ISDIR(status.st_mode)) return "it is a folder; add a file name";
        if (!S_ISREG(status.st_mode)) return access(path.c_str(), W_OK) == 0 ? "" : std::strerror(errno);
    } else if (errno != ENOENT) {
        return std::strerror(errno);
    }
    std::string temporary;
    const int file = create_temporary(folder_of(follow_links(path)), temporary);
    if (file < 0) return errno == ENOENT ? "its folder does not exist; create it first" : std::strerror(errno);
    if (!temporary.empty()) unlink(temporary.c_str());
    ::close(file);
    return {};
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
    stream_ = is_stream(path_);
    if (stream_) {
        file_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
        path_ = follow_links(path_);
        remove_leftovers_once(folder_of(path_));
        file_ = create_temporary(folder_of(path_), temporary_);
    }
    if (file_ < 0) {
        const int error = errno;
        temporary_.clear();
        fail("cannot be created", error);
    }
}

OutputFile::~OutputFile() {
    if (!temporary_.empty()) unlink(temporary_.c_str());
    close();
}

void OutputFile::write(const void* data, size_t bytes) {
    const char* at = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written = ::write(file_, at, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail("cannot be written", written < 0 ? errno : ENOSPC);
        at += written;
        bytes -= static_cast<size_t>(written);
    }
}

void OutputFile::sync() {
    // Pipes and some file systems have nothing to wait for.
    if (fsync(file_) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS) fail("cannot be written", errno);
}

void OutputFile::commit() {
    struct stat replaced{};
    const bool replaces = !stream_ && stat(path_.c_str(), &replaced) == 0;
    if (replaces) {
        // The new file gets the permissions of the old one. A file system without permissions refuses, which does no harm.
        const bool kept = fchmod(file_, replaced.st_mode & 07777) == 0;
        if (!kept && errno != EPERM && errno != ENOTSUP)
            fail("cannot be given the permissions of the file that it replaces", errno);
    }
    // linkat() never replaces a file. To replace one, the file needs a temporary name until rename().
    if (!stream_ && temporary_.empty() && (replaces || !link_to(path_))) {
        if (!replaces && errno != EEXIST) fail("cannot be put in place", errno);
        flock(file_, LOCK_EX | LOCK_NB);  // other processes would otherwise take it for a leftover
        std::string name;
        do {
            name = next_temporary_name(folder_of(path_));
        } while (!link_to(name) && errno == EEXIST);
        temporary_ = name;
    }
    // Network file systems report a full disk when a descriptor is closed. Close a duplicate, so that this is known before the
    // old file is replaced.
    const int other = dup(file_);
    if (other >= 0 && ::close(other) != 0 && errno != EINTR) fail("cannot be written", errno);
    if (!temporary_.empty() && rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot be put in place", errno);
    temporary_.clear();
    const int file = file_;
    file_ = -1;
    if (::close(file) != 0 && errno != EINTR) fail("cannot be written", errno);
}

bool OutputFile::link_to(const std::string& name) const {
    return linkat(AT_FDCWD, descriptor_path(file_).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

void OutputFile::close() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
}

void OutputFile::fail(const char* what, int error) const {
    throw Error(Exit::failed, path_ + ": " + what + ": " + std::strerror(error) +
                                  (error == ENOSPC ? "; free some space or write elsewhere" : ""));
}

void write_text_file(const std::string& path, const std::string& text) {
    OutputFile file(path);
    file.write(text.data(), text.size());
    file.commit();
}

void check_writable(const std::string& path) {
    if (const Problem why = why_not_writable(path)) throw Error(Exit::usage, "`" + path + "` cannot be written: " + why.text());
}

}  // namespace clarity
