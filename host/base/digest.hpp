// digest.hpp -- a digest of 128 bits that tells contents apart: XXH3 of Yann Collet's xxHash, about as fast as memory is read.
// It is no protection against contents that are made to look alike.
#pragma once
struct XXH3_state_s;

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

namespace clarity {

// Collects contents piece by piece. Used from one thread.
class Digest {
 public:
    Digest();
    ~Digest();
    Digest(const Digest&) = delete;
    Digest& operator=(const Digest&) = delete;

    void add_bytes(const void* data, size_t bytes);
    // Adds the length, too, so that "ab", "c" differs from "a", "bc".
    void add(const std::string& text);
    template <class T>
    void add_value(const T& value) {
        static_assert(std::is_arithmetic_v<T>, "a struct may have padding");
        add_bytes(&value, sizeof value);
    }
    // The digest of what was added so far: 32 digits in hexadecimal.
    std::string hex() const;

 private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
};

// The digest of a whole content.
std::string digest_of(const std::string& content);
// Another digest of it, by all cores: large contents are read as fast as memory is.
std::string digest_of_bytes(const void* data, uint64_t bytes);
// The same of a file, which is read piece by piece; empty if it cannot be read.
std::string digest_of_file(const std::string& path);

// A hash that tells contents apart. It is no protection against contents that are made to look alike.

// FNV-1a of 64 bits. seed: the hash of what comes before.
inline uint64_t hash_bytes(const void* data, size_t bytes, uint64_t seed = 14695981039346656037ull) {
    uint64_t hash = seed;
    const auto* at = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) hash = (hash ^ at[i]) * 1099511628211ull;
    return hash;
}

}  // namespace clarity
