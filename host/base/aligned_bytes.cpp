#include "base/aligned_bytes.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "base/machine.hpp"
#include "clarity_bvh/base/spare_blocks.hpp"

namespace clarity {
namespace {

constexpr size_t kMapped = 1u << 17;  // bytes; blocks from this size on are mapped, so that each page is cleared on first use
constexpr size_t kLargePage = 1u << 21, kPage = 1u << 16;  // bytes; ordinary pages are at most kPage on any machine

// Bytes to map for a block. Large blocks have few sizes, so that the next build, whose structure is a little smaller or larger,
// finds one; pages that are not used are no memory. Otherwise the last large page is used whole if at least half of it is
// needed, or the size is rounded up to kPage.
size_t mapped_bytes(size_t bytes) {
    size_t step = (bytes + kLargePage / 2) % kLargePage < kLargePage / 2 ? kLargePage : kPage;
    for (size_t coarse = kLargePage; coarse <= bytes / 16; coarse *= 2) step = coarse;
    return (bytes + step - 1) / step * step;
}

// Maps memory that begins at a multiple of a large page, so that a build faults once where it would fault 512 times. Returns
// nullptr if the system has no room.
void* map_large(size_t bytes) {
    void* const p = mmap(nullptr, bytes + kLargePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) return nullptr;
    char* const first = static_cast<char*>(p);
    const size_t before = (kLargePage - reinterpret_cast<uintptr_t>(p) % kLargePage) % kLargePage;
    if (before > 0) munmap(first, before);
    munmap(first + before + bytes, kLargePage - before);
    madvise(first + before, bytes, MADV_HUGEPAGE);  // only advice: it may fail
    return first + before;
}

bvh::SpareBlocks& spare_blocks() {
    static bvh::SpareBlocks& blocks =
        *new bvh::SpareBlocks(AlignedBytes::most_kept(), [](void* p, size_t bytes) { munmap(p, bytes); });
    return blocks;
}

}  // namespace

AlignedBytes::AlignedBytes(size_t bytes, bool zero) : bytes_(bytes) {
    if (bytes >= kMapped) {
        const size_t mapped = mapped_bytes(bytes);
        void* p = spare_blocks().take(mapped);
        if (p && zero) std::memset(p, 0, bytes);
        if (!p) p = map_large(mapped);
        if (!p) throw std::bad_alloc();
        data_ = std::unique_ptr<void, FreeMemory>(p, FreeMemory{mapped, false});
        return;
    }
    void* p = std::aligned_alloc(128, (bytes + 127) / 128 * 128);
    if (!p) throw std::bad_alloc();
    data_ = std::unique_ptr<void, FreeMemory>(p, FreeMemory{});
    if (zero) std::memset(p, 0, bytes);
}

void FreeMemory::operator()(void* p) const {
    if (borrowed) return;
    if (mapped)
        spare_blocks().give(p, mapped);
    else
        std::free(p);
}

void AlignedBytes::free(void* data, size_t bytes) {
    FreeMemory{bytes >= kMapped ? mapped_bytes(bytes) : 0, false}(data);
}

size_t AlignedBytes::most_kept() {
    static const size_t most = std::max(size_t{64} << 20, static_cast<size_t>(physical_memory_bytes() / 8));
    return most;
}

size_t AlignedBytes::kept() {
    return spare_blocks().sum();
}

}  // namespace clarity
