// scratch.hpp -- temporary memory of a build. It is not cleared.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>

#include "clarity_bvh/base/spare_blocks.hpp"

namespace clarity::bvh {

// The plugin's freed blocks.
inline SpareBlocks& spare_scratch() {
    static SpareBlocks& spare = *new SpareBlocks(size_t{1} << 30, [](void* p, size_t) { std::free(p); });
    return spare;
}
constexpr size_t kLeastSpare = size_t{1} << 16;  // in bytes; the heap itself keeps smaller blocks

// Uninitialised memory for `count` elements. The threads that fill it touch its pages first. It uses large pages where the
// system offers them, because page faults of small ones take a tenth of a build. Throws std::bad_alloc.
template <class T>
class Scratch {
 public:
    explicit Scratch(uint64_t count) : count_(count) {
        constexpr size_t kLargePage = SpareBlocks::kLarge;
        const size_t bytes = count * sizeof(T), alignment = bytes < kLargePage ? 64 : kLargePage;
        bytes_ = (bytes + alignment) / alignment * alignment;
        if (bytes_ >= kLeastSpare) data_ = spare_scratch().take(bytes_);
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
        if (bytes_ >= kLeastSpare)
            spare_scratch().give(data_, bytes_);
        else
            std::free(data_);
    }
    T* data() const { return static_cast<T*>(data_); }
    uint64_t count() const { return count_; }

 private:
    void* data_ = nullptr;
    size_t bytes_ = 0;
    uint64_t count_;
};

}  // namespace clarity::bvh
