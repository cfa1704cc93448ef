#include "bench/suites/gunzip.hpp"

#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "base/error.hpp"

namespace clarity::bench {
namespace {

constexpr unsigned kReadBytes = 1u << 20;  // bytes per read

// Writes all bytes to the open file `file`. Returns the reason of a failure, "" for success.
std::string write_all(int file, const char* at, size_t bytes) {
    while (bytes > 0) {
        const ssize_t written = write(file, at, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return std::strerror(written < 0 ? errno : ENOSPC);
        at += written;
        bytes -= static_cast<size_t>(written);
    }
    return {};
}

// Unpacks `from` into the open file `to`. Returns the reason of a failure, "" for success.
std::string unpack(gzFile from, int to) {
    std::vector<char> chunk(kReadBytes);
    for (;;) {
        errno = 0;
        const int got = gzread(from, chunk.data(), kReadBytes);
        int error = Z_OK;
        const std::string why = gzerror(from, &error);
        if (got < 0 || (error != Z_OK && error != Z_STREAM_END))
            return error == Z_BUF_ERROR ? "the file ends too early"
                   : error == Z_ERRNO   ? std::strerror(errno)
                                        : "the file is damaged: " + why;
        // zlib reads a file that is not compressed as it is, so that no error would be reported.
        if (gzdirect(from) && got > 0) return "it is not a gzip file";
        if (got == 0) return {};
        const std::string failed = write_all(to, chunk.data(), static_cast<size_t>(got));
        if (!failed.empty()) return "the temporary file cannot be written: " + failed;
    }
}

}  // namespace

TemporaryFile::~TemporaryFile() {
    if (!path_.empty()) unlink(path_.c_str());
}

TemporaryFile gunzip(const std::string& path) {
    const std::string stem = std::filesystem::path(path).stem().string();  // without ".gz"
    const auto fail = [&](const std::string& why) -> Error {
        return Error(Exit::import_failed, path + ": cannot be unpacked: " + why);
    };
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    if (error) throw fail("no folder for temporary files: " + error.message());
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> from(gzopen(path.c_str(), "rbe"), gzclose_r);
    if (!from) throw fail(std::strerror(errno));
    // Importers choose the format by the extension, so that the name must end with it.
    std::string name = (folder / ("clarity-XXXXXX-" + stem)).string();
    const int to = mkstemps(name.data(), static_cast<int>(stem.size() + 1));
    if (to < 0) throw fail(name + ": " + std::strerror(errno));
    TemporaryFile file(name);
    std::string why = unpack(from.get(), to);
    if (close(to) != 0 && why.empty()) why = std::strerror(errno);
    if (!why.empty()) throw fail(why);
    return file;
}

}  // namespace clarity::bench
