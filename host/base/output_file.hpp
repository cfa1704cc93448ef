// output_file.hpp -- files that appear whole or not at all.
#pragma once
#include <cstddef>
#include <string>

namespace clarity {

// A file that nobody sees until commit() gives it its name, or replaces an older file of that name. What is not committed
// leaves nothing behind, even if the process is killed; where the file system cannot hold files without a name (NFS, FAT), a
// killed process leaves `.clarity-PID-N.tmp`, which the next process that writes into the folder removes. Every failure throws
// Error(failed) that names the file and the reason. `path` may also be a device or a pipe (/dev/stdout), which is written
// straight away. One thread at a time.
class OutputFile {
 public:
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* data, size_t bytes);
    void commit();

 private:
    [[noreturn]] void fail(const char* what, int error) const;
    bool link_to(const std::string& name) const;  // errno says why not
    void close();

    std::string path_;
    std::string temporary_;  // name of the file until commit(); empty: it has none
    int file_ = -1;
    bool stream_ = false;  // a device or a pipe
};

void write_text_file(const std::string& path, const std::string& text);

// Throws Error(usage) if `path` cannot become a file: its folder is missing or not writable, it is a folder itself, its name is
// too long. Leaves nothing behind, and an old file as it is.
void check_writable(const std::string& path);

}  // namespace clarity
