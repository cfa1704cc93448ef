#include "base/files/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/text.hpp"

namespace clarity {
namespace {

std::string cannot_be_read(int error) {
    return std::string("cannot be read: ") + std::strerror(error) +
           (error == ENOENT || error == ENOTDIR ? "; check the name and the folder" : "");
}

class Descriptor {
 public:
    explicit Descriptor(const std::string& path) : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
    ~Descriptor() {
        if (fd_ >= 0) close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

 private:
    const int fd_;
};

}  // namespace

Problem try_read_file(const std::string& path, uint64_t limit_bytes, std::string& content) {
    const Descriptor file(path);
    struct stat status{};
    if (file.get() < 0 || fstat(file.get(), &status) != 0) return cannot_be_read(errno);
    if (S_ISDIR(status.st_mode)) return "is a folder; name a file in it";
    if (!S_ISREG(status.st_mode)) return "is no regular file, and may have no end; save its content to a file and name that";
    const std::string too_large =
        "is larger than " + memory_limit_text(limit_bytes) + ", the most that is read of such a file; is it the right one?";
    const auto size = static_cast<uint64_t>(status.st_size);
    if (size > limit_bytes) return too_large;
    // Read until read() returns 0: the file may grow meanwhile, and files of /proc claim to be empty. With one byte more than
    // the file's size one call usually finds the end.
    content.resize(static_cast<size_t>(std::min(size, limit_bytes)) + 1);
    size_t filled = 0;
    for (;;) {
        const ssize_t got = read(file.get(), content.data() + filled, content.size() - filled);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return cannot_be_read(errno);
        if (got == 0) break;
        filled += static_cast<size_t>(got);
        if (filled > limit_bytes) return too_large;
        if (filled == content.size()) content.resize(static_cast<size_t>(std::min<uint64_t>(2 * filled, limit_bytes + 1)));
    }
    content.resize(filled);
    return {};
}

std::string read_file(const std::string& path, uint64_t limit_bytes, Exit code) {
    std::string content;
    if (const Problem why = try_read_file(path, limit_bytes, content)) throw Error(code, path + ": " + why.text());
    return content;
}

}  // namespace clarity
