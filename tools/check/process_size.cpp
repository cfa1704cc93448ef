#include "tools/check/process_size.hpp"

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace clarity::check {
namespace {

constexpr uint64_t kThreadsOfPools = 4;  // so many may begin late

uint64_t entries_of(const char* folder) {
    uint64_t count = 0;
    DIR* open = opendir(folder);
    if (!open) return 0;
    while (readdir(open)) ++count;
    closedir(open);
    return count;
}

// What grows from one look to the next and to the one after it, `times` / 2 repetitions apart.
Outcome compare_sizes(const std::string& what, unsigned times, const ProcessSize& begin, const ProcessSize& middle,
                      const ProcessSize& end) {
    // Memory that grows in both halves is leaked; a cache grows once.
    const auto grows = [&](uint64_t ProcessSize::* member, uint64_t each) {
        const uint64_t a = begin.*member, b = middle.*member, c = end.*member, least = each * uint64_t(times / 2);
        return b > a && c > b && b - a >= least && c - b >= least;
    };
    const auto each = [&](uint64_t ProcessSize::* member) {
        return std::to_string((end.*member - begin.*member) / uint64_t(times));
    };
    const std::string after = " after " + std::to_string(times) + " " + what + "s";
    // Threads and files first: what belongs to them is on the heap, too.
    if (end.files > begin.files)
        return Outcome::failed(std::to_string(end.files - begin.files) + " files or pipes stay open" + after);
    if (end.threads > begin.threads + kThreadsOfPools)
        return Outcome::failed(std::to_string(end.threads - begin.threads) + " threads go on" + after);
    if (grows(&ProcessSize::heap_bytes, 8))
        return Outcome::failed("each " + what + " leaves " + each(&ProcessSize::heap_bytes) +
                               " bytes on the heap: it leaks memory");
    if (grows(&ProcessSize::mapped_bytes, 4096))
        return Outcome::failed("each " + what + " leaves " + each(&ProcessSize::mapped_bytes) +
                               " bytes mapped: it leaks memory");
    return Outcome::passed("nothing grows over " + std::to_string(times) + " " + what + "s");
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

Outcome find_leaks(const std::string& what, unsigned times, const std::function<void(unsigned)>& once) {
    unsigned count = 0;
    const auto repeat = [&](unsigned more) {
        for (const unsigned end = count + more; count < end; ++count) once(count);
        return process_size();
    };
    repeat(20);  // caches fill
    // Each thread of a pool has memory of its own from the first work that it gets, and keeps some of what it frees; on a busy
    // machine with many cores that goes on for hundreds of builds. What is leaked grows every time. So a small growth is looked
    // at longer.
    constexpr unsigned kLooks = 4, kLongLooks = 16;
    constexpr uint64_t kSmallGrowth = 1024;
    Outcome outcome;
    ProcessSize begin = repeat(0);
    for (unsigned look = 0, looks = kLooks; look < looks; ++look) {
        const ProcessSize middle = repeat(times / 2), end = repeat(times / 2);
        outcome = compare_sizes(what, times, begin, middle, end);
        if (outcome.kind != Outcome::Kind::failed) break;
        const bool heap_alone = end.files <= begin.files && end.threads <= begin.threads + kThreadsOfPools;
        const bool little = heap_alone && end.heap_bytes - begin.heap_bytes < kSmallGrowth * times;
        looks = little ? kLongLooks : kLooks;
        begin = end;
    }
    return outcome;
}

}  // namespace clarity::check
