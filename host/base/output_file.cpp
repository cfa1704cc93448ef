#include "base/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/error.hpp"

namespace clarity {
namespace {

bool is_stream(const std::string& path) {
    struct stat status {};
    return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

// A link keeps pointing where it points: the file that it leads to is the one to replace.
std::string follow_links(const std::string& path) {
    char* real = realpath(path.c_str(), nullptr);
    if (!real) return path;
    std::string result = real;
    std::free(real);
    return result;
}

// Creates PATH's temporary neighbour and opens it; -1 with errno set if that fails. The name begins with a dot and tells the
// program, so that what a power cut left can be told from a picture.
int create_temporary(const std::string& path, std::string& temporary) {
    static std::atomic<unsigned> number{0};
    const size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
    for (;;) {
        temporary = folder + ".clarity-" + std::to_string(getpid()) + "-" + std::to_string(number++) + ".tmp";
        const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0 || errno != EEXIST) return file;
    }
}

// What rename() would refuse, found before any work is done. Empty if nothing.
std::string why_not_writable(const std::string& path) {
    if (path.empty()) return "the name is empty";
    struct stat status {};
    if (stat(path.c_str(), &status) == 0) {
        if (S_ISDIR(status.st_mode)) return "it is a folder; add a file name";
        if (!S_ISREG(status.st_mode)) return access(path.c_str(), W_OK) == 0 ? "" : std::strerror(errno);
    } else if (errno != ENOENT) {
        return std::strerror(errno);
    }
    std::string temporary;
    const int file = create_temporary(follow_links(path), temporary);
    if (file < 0) return errno == ENOENT ? "its folder does not exist; create it first" : std::strerror(errno);
    ::close(file);
    unlink(temporary.c_str());
    return {};
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
    if (is_stream(path_)) {
        temporary_ = path_;
        file_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
        path_ = follow_links(path_);
        file_ = create_temporary(path_, temporary_);
    }
    if (file_ < 0) {
        const int error = errno;
        temporary_.clear();
        fail("cannot be created", error);
    }
}

OutputFile::~OutputFile() {
    close();
    if (!committed_ && !temporary_.empty() && temporary_ != path_) unlink(temporary_.c_str());
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

void OutputFile::commit() {
    struct stat replaced {};
    if (temporary_ != path_ && stat(path_.c_str(), &replaced) == 0) {
        // The old file's rights stay. A file system without rights refuses them, which does no harm.
        const bool kept = fchmod(file_, replaced.st_mode & 07777) == 0;
        if (!kept && errno != EPERM && errno != ENOTSUP) fail("cannot be given the rights of the file that it replaces", errno);
    }
    const int file = file_;
    file_ = -1;
    if (::close(file) != 0 && errno != EINTR) fail("cannot be written", errno);  // network file systems tell here
    if (temporary_ != path_ && rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot be put in place", errno);
    committed_ = true;
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
    const std::string why = why_not_writable(path);
    if (!why.empty()) throw Error(Exit::usage, "`" + path + "` cannot be written: " + why);
}

}  // namespace clarity
