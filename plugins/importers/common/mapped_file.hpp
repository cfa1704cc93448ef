// mapped_file.hpp -- the bytes of a file, mapped into memory, read-only. For importers.
#pragma once
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "rt_plugin.h"

namespace importers {

class MappedFile {
 public:
    // Maps the whole file. Throws std::runtime_error with the reason (without the file's name).
    explicit MappedFile(const std::string& path) { map(path); }
    // The file that an importer is to load. The host has its bytes if it is packed on disk.
    MappedFile(const rt_host* host, const std::string& path) {
        is_hosts_ = RT_HAS(host, rt_host, content_bytes) && host->content;
        if (!is_hosts_) {
            map(path);
            return;
        }
        data_ = reinterpret_cast<const char*>(host->content);
        size_ = static_cast<size_t>(host->content_bytes);
    }
    ~MappedFile() {
        if (data_ && !is_hosts_) ::munmap(const_cast<char*>(data_), size_);
    }
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return {data_, size_}; }
    // Gives back the memory of what was read so far. Bytes that are asked for again are read again.
    void forget() const {
        if (data_ && !is_hosts_) ::madvise(const_cast<char*>(data_), size_, MADV_DONTNEED);
    }

 private:
    void map(const std::string& path) {
        const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        if (file < 0) throw std::runtime_error(std::string("cannot open the file: ") + std::strerror(errno));
        struct stat about{};
        const bool known = ::fstat(file, &about) == 0 && S_ISREG(about.st_mode);
        size_ = known ? static_cast<size_t>(about.st_size) : 0;
        void* memory = size_ > 0 ? ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0) : nullptr;
        const int error = errno;
        ::close(file);
        if (!known)
            throw std::runtime_error(S_ISDIR(about.st_mode) ? std::string("cannot read the file: ") + std::strerror(EISDIR)
                                                            : "it is not a regular file");
        if (memory == MAP_FAILED) throw std::runtime_error(std::string("cannot read the file: ") + std::strerror(error));
        data_ = static_cast<const char*>(memory);
    }

    const char* data_ = nullptr;
    size_t size_ = 0;
    bool is_hosts_ = false;
};

}  // namespace importers
