#include "base/files/memory_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr int kSizeSeals = F_SEAL_SHRINK | F_SEAL_GROW, kSeals = F_SEAL_WRITE | kSizeSeals;
constexpr uint64_t kAtOnce = uint64_t{1} << 30;  // bytes: one call transfers less than 2 GiB

[[noreturn]] void fail(const char* what, const char* why) {
    throw Error(Exit::failed, std::string("shared memory cannot be ") + what + ": " + why);
}

struct stat status_of(int fd) {
    struct stat status{};
    if (fstat(fd, &status) != 0) fail("looked at", std::strerror(errno));
    return status;
}

// call(done, count) transfers up to `count` bytes and returns how many.
template <class Call>
void transfer(const char* what, uint64_t bytes, const Call& call) {
    for (uint64_t done = 0; done < bytes;) {
        const ssize_t count = call(done, std::min(kAtOnce, bytes - done));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) fail(what, count == 0 ? "it is shorter than it should be" : std::strerror(errno));
        done += static_cast<uint64_t>(count);
    }
}

bool has_seals(int fd, int wanted) {
    const int seals = fcntl(fd, F_GET_SEALS);
    return seals >= 0 && (seals & wanted) == wanted;
}

void add_seals(int fd, int seals) {
    if (fcntl(fd, F_ADD_SEALS, seals) != 0) fail("sealed", std::strerror(errno));
}

}  // namespace

MemoryFile::MemoryFile() : fd_(memfd_create("clarity", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    if (fd_ < 0) fail("made", std::strerror(errno));
}

MemoryFile::~MemoryFile() {
    if (fd_ >= 0) close(fd_);
}

MemoryFile::MemoryFile(MemoryFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

MemoryFile& MemoryFile::operator=(MemoryFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
}

std::optional<MemoryFile> MemoryFile::open(const Address& address) {
    const std::string path = "/proc/" + std::to_string(address.process) + "/fd/" + std::to_string(address.descriptor);
    // O_NONBLOCK: a process of another container may have a pipe there.
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) return std::nullopt;
    MemoryFile file(fd);
    struct stat status{};
    if (fstat(fd, &status) != 0 || status.st_dev != address.device || status.st_ino != address.inode) return std::nullopt;
    return file;
}

MemoryFile::Address MemoryFile::address() const {
    const struct stat status = status_of(fd_);
    return {getpid(), fd_, status.st_dev, status.st_ino};
}

uint64_t MemoryFile::bytes() const {
    return static_cast<uint64_t>(status_of(fd_).st_size);
}

void MemoryFile::write_at(uint64_t at, const void* from, uint64_t bytes) {
    transfer("written", bytes, [&](uint64_t done, uint64_t count) {
        return pwrite(fd_, static_cast<const char*>(from) + done, count, static_cast<off_t>(at + done));
    });
}

void MemoryFile::read_at(uint64_t at, void* to, uint64_t bytes) const {
    transfer("read", bytes, [&](uint64_t done, uint64_t count) {
        return pread(fd_, static_cast<char*>(to) + done, count, static_cast<off_t>(at + done));
    });
}

void MemoryFile::seal() {
    add_seals(fd_, kSeals);
}

bool MemoryFile::sealed() const {
    return has_seals(fd_, kSeals);
}

void MemoryFile::seal_size() {
    add_seals(fd_, kSizeSeals);
}

bool MemoryFile::size_sealed() const {
    return has_seals(fd_, kSizeSeals);
}

std::shared_ptr<const char> map_file(int fd, uint64_t bytes) {
    if (bytes == 0) fail("mapped", "it is empty");
    // Private: older kernels refuse a shared mapping of a file that is sealed against writing. Pages that nobody writes are
    // shared all the same.
    void* const map = mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE, fd, 0);
    if (map == MAP_FAILED) fail("mapped", std::strerror(errno));
    return {static_cast<const char*>(map), [bytes](const char* p) { munmap(const_cast<char*>(p), bytes); }};
}

}  // namespace clarity
