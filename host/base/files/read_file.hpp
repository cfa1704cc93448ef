// read_file.hpp -- reads a whole file into memory, up to a limit.
#pragma once
#include <cstdint>
#include <string>

#include "base/error.hpp"
#include "base/problem.hpp"

namespace clarity {

// Limits for the files that this program reads whole, in bytes.
constexpr uint64_t kMaxTextFileBytes = uint64_t{16} << 20;  // presets, preferences, kernels; they have only some kilobytes

// Reads the regular file `path` into `content`. Returns nothing on success, otherwise what is wrong and what to do,
// without the file's name. Refuses files of more than `limit_bytes`, and folders, pipes and devices, which may have no end;
// never waits for the writer of a pipe. `content` is undefined after a failure. For any thread.
Problem try_read_file(const std::string& path, uint64_t limit_bytes, std::string& content);

// The same, but returns the content. Throws Error(code) with "PATH: WHY".
std::string read_file(const std::string& path, uint64_t limit_bytes, Exit code);

}  // namespace clarity
