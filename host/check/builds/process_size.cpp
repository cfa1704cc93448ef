#include "check/builds/process_size.hpp"

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace clarity::check {
namespace {

uint64_t entries_of(const char* folder) {
    uint64_t count = 0;
    DIR* open = opendir(folder);
    if (!open) return 0;
    while (readdir(open)) ++count;
    closedir(open);
    return count;
}

}  // namespace

void use_one_arena() {
#ifdef __GLIBC__
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, 1 << 20);  // fixed, so that it does not adapt while memory is measured
#endif
}

ProcessSize process_size() {
    ProcessSize size;
#ifdef __GLIBC__
    const struct mallinfo2 heap = mallinfo2();
    size.heap_bytes = heap.uordblks + heap.hblkhd;
#endif
    unsigned long long pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
        if (std::fscanf(file, "%llu", &pages) != 1) pages = 0;
        std::fclose(file);
    }
    size.mapped_bytes = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    size.files = entries_of("/proc/self/fd");
    size.threads = entries_of("/proc/self/task");
    return size;
}

}  // namespace clarity::check
