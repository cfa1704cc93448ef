// importer.cpp -- the bytes of a file, through an importer plugin whose sources are linked. FUZZ_EXTENSION: the file's
// extension.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "reading_sink.hpp"

namespace {

// A name with the extension for a file in memory. Its folder is empty, so that nothing beside it can be read.
class MemoryFile {
 public:
    MemoryFile() : file_(memfd_create("fuzz", 0)) {
        char folder[] = "/tmp/fuzz_XXXXXX";
        if (file_ < 0 || !mkdtemp(folder)) std::abort();
        path_ = std::string(folder) + "/fuzz." FUZZ_EXTENSION;
        if (symlink(("/proc/self/fd/" + std::to_string(file_)).c_str(), path_.c_str()) != 0) std::abort();
    }
    ~MemoryFile() {
        unlink(path_.c_str());
        rmdir(path_.substr(0, path_.rfind('/')).c_str());
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    void write(const uint8_t* data, size_t size) {
        if (ftruncate(file_, 0) != 0 || pwrite(file_, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
    }
    const char* path() const { return path_.c_str(); }

 private:
    int file_;
    std::string path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static MemoryFile file;
    if (size == 0) return 0;  // the host refuses an empty file itself
    file.write(data, size);
    clarity::fuzz::ReadingSink sink;
    const rt_importer& importer = *rt_plugin_v1.importer;
    if (importer.probe) importer.probe(data, size);
    importer.load(sink.host(), file.path(), nullptr, sink.sink());
    return 0;
}
