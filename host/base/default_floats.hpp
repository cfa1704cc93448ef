// default_floats.hpp -- the rules of floating point as a program starts with them, for a while.
#pragma once
#include <cfenv>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace clarity {

// Embree, and whoever else wants speed, lets a thread flush denormals to zero for good. Builders keep indices in lanes of float
// vectors, where a small index is a denormal: flushed, primitives would be lost from a tree without a word.
class DefaultFloats {
 public:
    DefaultFloats(const DefaultFloats&) = delete;
    DefaultFloats& operator=(const DefaultFloats&) = delete;
#ifdef __SSE2__
    // One register holds the rules, and as a rule they are the usual ones; fesetenv() would take 50 ns, in every body of a
    // loop.
    DefaultFloats() : before_(_mm_getcsr()) {
        if ((before_ & kRules) != kUsual) _mm_setcsr(kUsual);
    }
    ~DefaultFloats() {
        if ((before_ & kRules) != kUsual) _mm_setcsr(before_);
    }

 private:
    static constexpr unsigned kRules = 0xffc0, kUsual = 0x1f80;  // without what has happened so far; all exceptions masked
    const unsigned before_;
#else
    DefaultFloats() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~DefaultFloats() {
        std::fesetenv(&before_);
    }

 private:
    std::fenv_t before_;
#endif
};

}  // namespace clarity
