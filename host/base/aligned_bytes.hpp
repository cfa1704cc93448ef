// aligned_bytes.hpp -- memory for what is large, comes and goes as a whole and is filled by all threads: structures and what
// they are built from.
#pragma once
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace clarity {

struct FreeMemory {
    size_t mapped = 0;  // bytes; 0: from the heap
    void operator()(void* p) const;
};

// Storage aligned to 128 bytes, as buffers of devices are (OpenCL's largest type); never grows.
class AlignedBytes {
 public:
    AlignedBytes() = default;
    explicit AlignedBytes(size_t bytes, bool zero);
    void* data() { return data_.get(); }
    const void* data() const { return data_.get(); }
    size_t bytes() const { return bytes_; }

    // For owners of another kind, which give back what they took with `free`.
    void* release() { return data_.release(); }
    static void free(void* data, size_t bytes);

    // Of what was freed the latest blocks are kept, for the next build of the same scene: the system would have to clear them
    // anew.
    static constexpr size_t kKept = size_t{64} << 20;
    static size_t kept();

 private:
    std::unique_ptr<void, FreeMemory> data_;
    size_t bytes_ = 0;
};

// For vectors that are filled before they are read, by many threads: their elements are not cleared first, on one.
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
