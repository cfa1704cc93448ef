// output_file.hpp -- files that appear whole or not at all.
#pragma once
#include <cstddef>
#include <string>

namespace clarity {

// Written under a temporary name in the same folder, and given its real name by commit(). What is not committed leaves nothing
// behind. Every failure throws Error(failed) that names the file and the reason. `path` may also be a device or a pipe
// (/dev/stdout), which is written straight away.
class OutputFile {
 public:
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* data, size_t bytes);
    // Where a library that opens files by itself has to write.
    const std::string& temporary_path() const { return temporary_; }
    void commit();

 private:
    [[noreturn]] void fail(const char* what, int error) const;
    void close();

    std::string path_, temporary_;
    int file_ = -1;
    bool committed_ = false;
};

void write_text_file(const std::string& path, const std::string& text);

// Throws Error(usage) if `path` cannot become a file: its folder is missing or not writable, it is a folder itself, its name is
// too long. Leaves nothing behind, and an old file as it is.
void check_writable(const std::string& path);

}  // namespace clarity
