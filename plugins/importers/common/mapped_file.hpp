// mapped_file.hpp -- maps a file into memory, read-only. For importers.
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

namespace importers {

class MappedFile {
 public:
    // Maps the whole file. Throws std::runtime_error with the reason (without the file's name).
    explicit MappedFile(const std::string& path) {
        const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        if (file < 0) throw std::runtime_error(std::string("cannot open the file: ") + std::strerror(errno));
        struct stat about {};
        const bool known = ::fstat(file, &about) == 0 && S_ISREG(about.st_mode);
        size_ = known ? static_cast<size_t>(about.st_size) : 0;
        void* memory = size_ > 0 ? ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0) : nullptr;
        const int error = errno;
        ::close(file);
        if (!known) throw std::runtime_error("it is not a regular file");
        if (memory == MAP_FAILED) throw std::runtime_error(std::string("cannot read the file: ") + std::strerror(error));
        data_ = static_cast<const char*>(memory);
    }
    ~MappedFile() {
        if (data_) ::munmap(const_cast<char*>(data_), size_);
    }
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return {data_, size_}; }
    // Gives back the memory of what was read so far. Bytes that are asked for again are read again.
    void forget() const {
        if (data_) ::madvise(const_cast<char*>(data_), size_, MADV_DONTNEED);
    }

 private:
    const char* data_ = nullptr;
    size_t size_ = 0;
};

}  // namespace importers
