// lowbias32.hpp -- a 32-bit hash of low bias: Wellons 2018, "Prospecting for Hash Functions". The same on all machines.
#pragma once
#include <cstdint>

namespace clarity {

constexpr uint32_t lowbias32(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

}  // namespace clarity
