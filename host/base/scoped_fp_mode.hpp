// scoped_fp_mode.hpp -- sets the default floating-point mode for a scope.
#pragma once
#include <cfenv>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace clarity {

// Restores the mode (rounding, exceptions, denormals) that a program starts with, until the end of the scope. Libraries such as
// Embree let a thread flush denormals to zero and leave it so. Our builders keep indices in lanes of float vectors, where a
// small index is a denormal: if it were flushed, the tree would silently lose primitives.
class ScopedFpMode {
 public:
    ScopedFpMode(const ScopedFpMode&) = delete;
    ScopedFpMode& operator=(const ScopedFpMode&) = delete;
#ifdef __SSE2__
    // One register (MXCSR) holds the mode, and it is nearly always the default one already. fesetenv() would take 50 ns in
    // every body of a loop.
    ScopedFpMode() : before_(_mm_getcsr()) {
        if ((before_ & kRules) != kDefault) _mm_setcsr(kDefault);
    }
    ~ScopedFpMode() {
        if ((before_ & kRules) != kDefault) _mm_setcsr(before_);
    }

 private:
    static constexpr unsigned kRules = 0xffc0, kDefault = 0x1f80;  // mode bits (no exception flags); all exceptions masked
    const unsigned before_;
#else
    ScopedFpMode() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~ScopedFpMode() { std::fesetenv(&before_); }

 private:
    std::fenv_t before_;
#endif
};

}  // namespace clarity
