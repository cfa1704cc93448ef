// default_floats.hpp -- the rules of floating point as a program starts with them, for a while.
#pragma once
#include <cfenv>

namespace clarity {

// Embree, and whoever else wants speed, lets a thread flush denormals to zero for good. Builders keep indices in lanes of float
// vectors, where a small index is a denormal: flushed, primitives would be lost from a tree without a word.
class DefaultFloats {
 public:
    DefaultFloats() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~DefaultFloats() { std::fesetenv(&before_); }
    DefaultFloats(const DefaultFloats&) = delete;
    DefaultFloats& operator=(const DefaultFloats&) = delete;

 private:
    std::fenv_t before_;
};

}  // namespace clarity
