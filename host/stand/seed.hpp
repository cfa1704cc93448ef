// seed.hpp -- random numbers of what is made by formula: the same ones each time, unless the user gives a seed.
#pragma once
#include <cstdint>
#include <random>

namespace clarity {

// own: the number of the maker or the check, so that two do not draw the same. seed: the user's (--seed); with 0, the numbers
// are those of std::mt19937(own).
inline std::mt19937 random_of(unsigned own, uint64_t seed) {
    if (seed == 0) return std::mt19937(own);
    std::seed_seq words{own, static_cast<unsigned>(seed), static_cast<unsigned>(seed >> 32)};
    return std::mt19937(words);
}

}  // namespace clarity
