// aligned_bytes.hpp -- memory for large arrays which all threads fill and which are freed as a whole: acceleration structures
// and the input of their builders.
#pragma once
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace clarity {

// Deleter of the memory of AlignedBytes.
struct FreeMemory {
    size_t mapped = 0;      // size of the mapping in bytes; 0: the memory is from the heap
    bool borrowed = false;  // the memory belongs to someone else
    void operator()(void* p) const;
};

// Owns a block of memory that never grows. It is aligned to 128 bytes, the size of OpenCL's largest type, as device buffers
// are.
class AlignedBytes {
 public:
    AlignedBytes() = default;
    // `zero`: the memory is cleared. Throws std::bad_alloc.
    explicit AlignedBytes(size_t bytes, bool zero);
    // Refers to memory of another owner, which must be aligned as stated and outlive the result.
    static AlignedBytes borrow(void* data, size_t bytes) {
        AlignedBytes result;
        result.data_ = std::unique_ptr<void, FreeMemory>(data, FreeMemory{0, true});
        result.bytes_ = bytes;
        return result;
    }
    void* data() { return data_.get(); }
    const void* data() const { return data_.get(); }
    size_t bytes() const { return bytes_; }

    // For owners of another type: release() hands the block over, and they return it with free(data, bytes).
    void* release() { return data_.release(); }
    static void free(void* data, size_t bytes);

    // Freed mapped blocks are kept for the next build of the same scene, the latest ones first, up to this many bytes in all:
    // the system would have to clear new pages, which takes longer than the build of a large scene. It may take pages of large
    // blocks back when memory is short and nobody has used them for some seconds (clarity_bvh/base/spare_blocks.hpp).
    static size_t most_kept();
    // Bytes of the freed blocks that are kept now.
    static size_t kept();

 private:
    std::unique_ptr<void, FreeMemory> data_;
    size_t bytes_ = 0;
};

// For vectors that many threads fill before anyone reads them: one thread need not clear all elements first.
template <class T>
struct DefaultInitAllocator {
    using value_type = T;
    DefaultInitAllocator() = default;
    template <class U>
    DefaultInitAllocator(const DefaultInitAllocator<U>&) {}
    T* allocate(size_t n) {
        AlignedBytes bytes(n * sizeof(T), false);
        return static_cast<T*>(bytes.release());
    }
    void deallocate(T* p, size_t n) { AlignedBytes::free(p, n * sizeof(T)); }
    template <class U>
    void construct(U* p) {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... Args>
    void construct(U* p, Args&&... args) {
        ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
    }
    bool operator==(const DefaultInitAllocator&) const { return true; }
    bool operator!=(const DefaultInitAllocator&) const { return false; }
};
template <class T>
using UninitializedVector = std::vector<T, DefaultInitAllocator<T>>;

}  // namespace clarity
