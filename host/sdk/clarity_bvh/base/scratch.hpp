// scratch.hpp -- temporary memory of a build. It is not cleared.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <new>
#include <utility>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace clarity::bvh {

// Keeps freed blocks for the next build, in order of their release. Without it, memory would go back to the system, which
// clears the pages again for the next allocation. Building the same scene again asks for blocks of the same sizes. The system
// may take the pages of large blocks back when memory is short.
class SpareScratch {
 public:
    static constexpr size_t kKept = size_t{1} << 30, kMost = 16;
    static constexpr size_t kLeast = size_t{1} << 16;  // in bytes; the heap itself keeps smaller blocks
    static constexpr size_t kLarge = size_t{1} << 21;  // in bytes: of a large page

    void* take(size_t bytes) {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (size_t i = count_; i-- > 0;)
            if (blocks_[i].bytes == bytes) return remove(i);
        return nullptr;
    }
    void give(void* p, size_t bytes) {
        if (bytes > kKept) return std::free(p);
#ifdef MADV_FREE
        if (bytes >= kLarge) madvise(p, bytes, MADV_FREE);
#endif
        const std::lock_guard<std::mutex> lock(mutex_);
        while (count_ == kMost || sum_ + bytes > kKept) std::free(remove(0));
        blocks_[count_++] = {p, bytes};
        sum_ += bytes;
    }
    // The plugin's only instance. It is never destroyed, because the plugin is never unloaded.
    static SpareScratch& instance() {
        static SpareScratch& spare = *new SpareScratch;
        return spare;
    }

 private:
    struct Block {
        void* p;
        size_t bytes;
    };
    void* remove(size_t i) {
        void* const p = blocks_[i].p;
        sum_ -= blocks_[i].bytes;
        std::copy(blocks_ + i + 1, blocks_ + count_, blocks_ + i);
        --count_;
        return p;
    }

    std::mutex mutex_;
    Block blocks_[kMost];
    size_t count_ = 0, sum_ = 0;
};

// Uninitialised memory for `count` elements. The threads that fill it touch its pages first. It uses large pages where the
// system offers them, because page faults of small ones take a tenth of a build. Throws std::bad_alloc.
template <class T>
class Scratch {
 public:
    explicit Scratch(uint64_t count) : count_(count) {
        constexpr size_t kLargePage = SpareScratch::kLarge;
        const size_t bytes = count * sizeof(T), alignment = bytes < kLargePage ? 64 : kLargePage;
        bytes_ = (bytes + alignment) / alignment * alignment;
        if (bytes_ >= SpareScratch::kLeast) data_ = SpareScratch::instance().take(bytes_);
        if (data_) return;
        data_ = std::aligned_alloc(alignment, bytes_);
        if (!data_) throw std::bad_alloc();
#ifdef __linux__
        if (alignment == kLargePage) madvise(data_, bytes_, MADV_HUGEPAGE);  // only advice: may fail
#endif
    }
    Scratch(Scratch&& from) noexcept : data_(std::exchange(from.data_, nullptr)), bytes_(from.bytes_), count_(from.count_) {}
    Scratch& operator=(Scratch&&) = delete;
    ~Scratch() {
        if (!data_) return;  // moved
        if (bytes_ >= SpareScratch::kLeast)
            SpareScratch::instance().give(data_, bytes_);
        else
            std::free(data_);
    }
    T* data() const {
        return static_cast<T*>(data_);
    }
    uint64_t count() const {
        return count_;
    }

 private:
    void* data_ = nullptr;
    size_t bytes_ = 0;
    uint64_t count_;
};

}  // namespace clarity::bvh
