// output_file.hpp -- writes files which appear complete or not at all.
#pragma once
#include <atomic>
#include <cstddef>
#include <string>

namespace clarity {

// A new file. It is invisible to others until commit() gives it its name or replaces an older file of that name. A file that is
// not committed leaves nothing behind, even if the process is killed. Exception: where the file system has no files without a
// name (NFS, FAT), a killed process leaves `.clarity-HOST-PID-START-N.tmp`; the next process of that host that writes into the
// folder removes it.
// `path` may also be a device or a pipe (/dev/stdout), which is written directly. Every failure throws Error(failed), which
// names the file and the reason. For one thread at a time.
class OutputFile {
 public:
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* data, size_t bytes);
    // Waits until what was written is on the disk, so that the file is also whole if the power fails after commit().
    void sync();
    // Finishes the file: afterwards it is complete and has its name.
    void commit();

 private:
    [[noreturn]] void fail(const char* what, int error) const;
    bool link_to(const std::string& name) const;  // on failure errno gives the reason
    void close();

    std::string path_;
    std::string temporary_;  // name of the file until commit(); empty if it has none
    int file_ = -1;
    bool stream_ = false;  // the path is a device or a pipe
};

// Writes a file in one call, as OutputFile does.
void write_text_file(const std::string& path, const std::string& text);

// Throws Error(usage) if `path` cannot be written as a file: its folder is missing or not writable, it is itself a folder, or
// its name is too long. Creates nothing and does not change an existing file.
void check_writable(const std::string& path);

// Whether a file is being made, so that a program that has to end gives it the time.

// Exists from the first step of making a file, its encoding, to the last. Any thread may have some.
class PendingWrite {
 public:
    PendingWrite() { ++count(); }
    ~PendingWrite() { --count(); }
    PendingWrite(const PendingWrite&) = delete;
    PendingWrite& operator=(const PendingWrite&) = delete;
    // Whether there is one in this process.
    static bool any() { return count() > 0; }

 private:
    static std::atomic<int>& count() {
        static std::atomic<int> writes{0};
        return writes;
    }
};

}  // namespace clarity
