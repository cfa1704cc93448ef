// temporary_folder.hpp -- a folder that goes with its object.
#pragma once
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "base/error.hpp"

namespace clarity {

class TemporaryFolder {
 public:
    // Makes NAME-XXXXXX in the system's folder for temporary files. Throws Error(failed).
    explicit TemporaryFolder(const std::string& name) {
        std::error_code error;
        const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
        path_ = ((error ? std::filesystem::path("/tmp") : parent) / (name + "-XXXXXX")).string();
        if (!mkdtemp(path_.data()))
            throw Error(Exit::failed,
                        path_ + ": cannot be made: " + std::strerror(errno) + "; set TMPDIR to a folder with room");
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::string& path() const { return path_; }

 private:
    std::string path_;
};

}  // namespace clarity
