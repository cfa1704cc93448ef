// memory_file.hpp -- a file in memory, which processes of one host can share.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

namespace clarity {

// Owns a descriptor. The file is gone when no process has a descriptor or a mapping of it, however they end. Functions throw
// Error(failed). For one thread at a time.
class MemoryFile {
 public:
    // Where another process of this host finds the file: numbers, so that they can be sent as bytes.
    struct Address {
        int64_t process = 0, descriptor = 0;
        uint64_t device = 0, inode = 0;  // of the file: a process of another container may have the same number
    };

    MemoryFile();  // empty
    ~MemoryFile();
    MemoryFile(MemoryFile&& other) noexcept;
    MemoryFile& operator=(MemoryFile&& other) noexcept;

    // The file of a descriptor, which the result owns.
    static MemoryFile of(int fd) { return MemoryFile(fd); }
    // The file of another process, for reading. None if it cannot be opened, for example because /proc of that process is not
    // to be seen.
    static std::optional<MemoryFile> open(const Address& address);
    Address address() const;

    int fd() const { return fd_; }
    uint64_t bytes() const;
    void write_at(uint64_t at, const void* from, uint64_t bytes);
    void read_at(uint64_t at, void* to, uint64_t bytes) const;
    // No process can change the file from now on. Fails while it is mapped for writing.
    void seal();
    bool sealed() const;
    // No process can change its size from now on.
    void seal_size();
    bool size_sealed() const;

 private:
    explicit MemoryFile(int fd) : fd_(fd) {}
    int fd_;
};

// The bytes of a file, mapped for reading: processes that map it share its memory. The mapping lasts as long as the pointer or
// a copy of it. Throws Error(failed). The file must not shrink meanwhile, so seal it first.
std::shared_ptr<const char> map_file(int fd, uint64_t bytes);

}  // namespace clarity
