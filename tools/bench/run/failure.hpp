// failure.hpp -- the message for an exception which ends a row of a benchmark.
#pragma once
#include <exception>
#include <new>
#include <string>

namespace clarity::bench {

inline std::string failure_text(const std::exception& e) {
    if (dynamic_cast<const std::bad_alloc*>(&e))
        return "not enough memory on the host: close other programs, or measure fewer structures or a smaller scene at a time";
    return e.what();
}

}  // namespace clarity::bench
