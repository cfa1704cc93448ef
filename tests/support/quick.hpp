// quick.hpp -- how much of a test is run.
#pragma once
#include <cstdlib>

namespace clarity::test {

// CLARITY_QUICK_TESTS is set, as by ./test without --all.
inline bool quick() {
    static const bool is_quick = std::getenv("CLARITY_QUICK_TESTS") != nullptr;
    return is_quick;
}

}  // namespace clarity::test
