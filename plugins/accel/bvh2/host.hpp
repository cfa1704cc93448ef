// host.hpp -- the host's services as the builder uses them.
#pragma once
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

#include "rt_plugin.h"
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace bvh2 {

class Host {
 public:
    explicit Host(const rt_host* host) : host_(host) {}
    template <class F>
    void parallel_for(size_t count, const F& body) const {
        host_->parallel_for(
            host_->ctx, static_cast<rt_u32>(count), [](void* user, rt_u32 i) { (*static_cast<const F*>(user))(i); },
            const_cast<void*>(static_cast<const void*>(&body)));
    }
    // False once the user cancelled. Any thread.
    bool report(float fraction) {
        if (!cancelled_ && !host_->progress(host_->ctx, fraction)) cancelled_ = true;
        return !cancelled_;
    }
    bool cancelled() const { return cancelled_; }

 private:
    const rt_host* host_;
    std::atomic<bool> cancelled_{false};
};

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
