// read_file.hpp -- reads a whole file into memory, up to a limit.
#pragma once
#include <cstdint>
#include <string>

#include "base/error.hpp"

namespace clarity {

// Limits for the files that this program reads whole, in bytes.
constexpr uint64_t kMaxTextFileBytes = uint64_t{16} << 20;  // presets, preferences, kernels: a large one has some kilobytes

// Reads the regular file `path` into `content`. Returns "" on success, else what is wrong and what to do, without the file's
// name. Refuses folders, pipes and devices, which may have no end, and files of more than `limit_bytes`. Does not wait for a
// pipe's writer. `content` is undefined after a failure. Any thread.
std::string try_read_file(const std::string& path, uint64_t limit_bytes, std::string& content);

// The same, but returns the content and throws Error(code) with "PATH: WHY".
std::string read_file(const std::string& path, uint64_t limit_bytes, Exit code);

}  // namespace clarity
