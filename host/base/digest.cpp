#include "base/digest.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <new>
#include <vector>

#include "base/parallel_for.hpp"

namespace clarity {

void Digest::Free::operator()(XXH3_state_s* state) const {
    XXH3_freeState(state);
}

Digest::Digest() : state_(XXH3_createState()) {
    if (!state_) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
}
Digest::~Digest() = default;

void Digest::add_bytes(const void* data, size_t bytes) {
    if (bytes > 0) XXH3_128bits_update(state_.get(), data, bytes);
}

void Digest::add(const std::string& text) {
    add_value(uint64_t(text.size()));
    add_bytes(text.data(), text.size());
}

std::string Digest::hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    char text[33];
    std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                  static_cast<unsigned long long>(hash.low64));
    return text;
}

std::string digest_of(const std::string& content) {
    Digest digest;
    digest.add_bytes(content.data(), content.size());
    return digest.hex();
}

std::string digest_of_bytes(const void* data, uint64_t bytes) {
    constexpr uint64_t kPiece = uint64_t{1} << 20;
    std::vector<XXH128_hash_t> pieces((bytes + kPiece - 1) / kPiece);
    parallel_for(static_cast<uint32_t>(pieces.size()), [&](uint32_t i) {
        const uint64_t first = i * kPiece;
        pieces[i] = XXH3_128bits(static_cast<const char*>(data) + first, std::min(kPiece, bytes - first));
    });
    Digest whole;
    whole.add_value(bytes);
    for (const XXH128_hash_t& piece : pieces) {
        whole.add_value(piece.high64);
        whole.add_value(piece.low64);
    }
    return whole.hex();
}

std::string digest_of_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return {};
    Digest digest;
    std::vector<char> piece(size_t(1) << 20);
    do {
        file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
        digest.add_bytes(piece.data(), size_t(file.gcount()));
    } while (file);
    return file.bad() ? std::string() : digest.hex();
}

}  // namespace clarity
