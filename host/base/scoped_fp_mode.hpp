// scoped_fp_mode.hpp -- the rules of floating point as a program starts with them, for a while.
#pragma once
#include <cfenv>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace clarity {

// Embree, and whoever else wants speed, lets a thread flush denormals to zero for good. Builders keep indices in lanes of float
// vectors, where a small index is a denormal: flushed, primitives would be lost from a tree without a word.
class ScopedFpMode {
 public:
    ScopedFpMode(const ScopedFpMode&) = delete;
    ScopedFpMode& operator=(const ScopedFpMode&) = delete;
#ifdef __SSE2__
    // One register holds the rules, and as a rule they are the usual ones; fesetenv() would take 50 ns, in every body of a
    // loop.
    ScopedFpMode() : before_(_mm_getcsr()) {
        if ((before_ & kRules) != kDefault) _mm_setcsr(kDefault);
    }
    ~ScopedFpMode() {
        if ((before_ & kRules) != kDefault) _mm_setcsr(before_);
    }

 private:
    static constexpr unsigned kRules = 0xffc0, kDefault = 0x1f80;  // without what has happened so far; all exceptions masked
    const unsigned before_;
#else
    ScopedFpMode() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~ScopedFpMode() {
        std::fesetenv(&before_);
    }

 private:
    std::fenv_t before_;
#endif
};

}  // namespace clarity
