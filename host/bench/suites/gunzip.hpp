// gunzip.hpp -- unpacks a compressed model into a temporary file, which importers can read.
#pragma once
#include <string>

namespace clarity::bench {

// Owns a temporary file: the destructor deletes it.
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

// Unpacks a .gz file into the folder for temporary files. "dir/bunny.ply.gz" becomes a file with a name that ends in
// "bunny.ply", because importers choose the format by the extension. Throws Error(import_failed) if the file cannot be read or
// unpacked.
TemporaryFile gunzip(const std::string& path);

}  // namespace clarity::bench
