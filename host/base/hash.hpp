// hash.hpp -- a hash that tells contents apart. It is no protection against somebody who wants two to be alike.
#pragma once
#include <cstddef>
#include <cstdint>

namespace clarity {

// FNV-1a of 64 bits. seed: the hash of what comes before.
inline uint64_t hash_bytes(const void* data, size_t bytes, uint64_t seed = 14695981039346656037ull) {
    uint64_t hash = seed;
    const auto* at = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) hash = (hash ^ at[i]) * 1099511628211ull;
    return hash;
}

}  // namespace clarity
