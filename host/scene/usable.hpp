// usable.hpp -- which numbers of a file a scene takes.
#pragma once
#include <algorithm>
#include <cstdint>
#include <iterator>

namespace clarity {

// Larger coordinates are treated as not finite, so that squares, areas of boxes, and their sums over all primitives, fit in a
// float.
inline constexpr float kMostCoordinate = 1e15f;

template <class Number>
bool is_usable(Number n) {
    return n <= Number(kMostCoordinate) && n >= -Number(kMostCoordinate);
}
template <class Number>
bool are_usable(const Number* values, uint64_t count) {
    return std::all_of(values, values + count, is_usable<Number>);
}
template <class Array>
bool are_usable(const Array& values) {
    return are_usable(std::data(values), std::size(values));
}

}  // namespace clarity
