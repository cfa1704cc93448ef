// packed_file.hpp -- files that are packed with gzip (bunny.ply.gz; RFC 1952). They are known by their first bytes, whatever
// their name is.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include "base/problem.hpp"

namespace clarity {

bool is_packed(const std::string& path);
// The name of what is packed: "dir/bunny.ply" for "dir/bunny.ply.gz" or ".GZ"; other names stay as they are.
std::string name_without_gz(const std::string& path);

// The most bytes that a packed file may unpack to: 64 times its own, but 1 GiB at least. Models come to 3 to 20 times. A file
// that goes beyond was made to fill the memory.
uint64_t most_unpacked_bytes(uint64_t packed_bytes);
// How many bytes the file will have unpacked, as far as its end says so; the file's size if it is not packed. It may be wrong,
// and is at most most_unpacked_bytes().
uint64_t stated_content_bytes(const std::string& path);

// Unpacks at most the first `most` bytes into `content`. progress: takes 0..1; may be empty. Returns nothing on success,
// otherwise what is wrong and what to do, without the file's name. Content that goes on behind `most` is no failure. For any
// thread.
Problem unpack_head(const std::string& path, uint64_t most, std::string& content);
// Unpacks the whole file, within most_unpacked_bytes() and the memory that this process may have. Likewise.
Problem unpack_file(const std::string& path, const std::function<void(float)>& progress, std::string& content);

}  // namespace clarity
