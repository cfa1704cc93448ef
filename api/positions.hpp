// positions.hpp -- which numbers of the caller's arrays a scene takes.
#pragma once
#include <cstddef>

#include "base/problem.hpp"

namespace clarity::api {

// What is wrong with the first number that is not finite or too large. of_each: numbers of one element; each: its name,
// "vertex".
Problem problem_of_numbers(const float* numbers, size_t count, size_t of_each, const char* each);
// The same of x, y, z of vertices, and whether all of them together are too small to be hit.
Problem problem_of_positions(const float* numbers, size_t count);

}  // namespace clarity::api
