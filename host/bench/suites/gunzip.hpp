// gunzip.hpp -- a compressed model as a file that importers read.
#pragma once
#include <string>

namespace clarity::bench {

// Lives as long as the object, in the folder for temporary files.
class TemporaryFile {
 public:
    explicit TemporaryFile(std::string path) : path_(std::move(path)) {}
    TemporaryFile(TemporaryFile&& other) noexcept : path_(std::move(other.path_)) { other.path_.clear(); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile();
    const std::string& path() const { return path_; }

 private:
    std::string path_;
};

// "dir/bunny.ply.gz" -> a file that ends in "bunny.ply". Throws Error(import_failed).
TemporaryFile gunzip(const std::string& path);

}  // namespace clarity::bench
