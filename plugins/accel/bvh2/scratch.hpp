// scratch.hpp -- memory that is filled before it is read.
#pragma once
#include <cstdlib>
#include <memory>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace bvh2 {

// Memory that nobody clears first: its pages are touched by the threads that fill them, and in large pages where the system has
// them (the faults of small ones are a tenth of a build).
template <class T>
class Scratch {
 public:
    explicit Scratch(uint64_t count) {
        constexpr size_t kLargePage = size_t{1} << 21;
        size_t bytes = count * sizeof(T);
        const size_t alignment = bytes < 4 * kLargePage ? 64 : kLargePage;
        bytes = (bytes + alignment) / alignment * alignment;
        data_.reset(std::aligned_alloc(alignment, bytes));
        if (!data_) throw std::bad_alloc();
#ifdef __linux__
        if (alignment == kLargePage) madvise(data_.get(), bytes, MADV_HUGEPAGE);  // advice: may fail
#endif
    }
    T* data() const {
        return static_cast<T*>(data_.get());
    }

 private:
    struct Free {
        void operator()(void* p) const { std::free(p); }
    };
    std::unique_ptr<void, Free> data_;
};

}  // namespace bvh2
