// inflate.hpp -- bytes that were deflated (zlib). For importers; they link to ZLIB::ZLIB.
#pragma once
#include <zlib.h>

#include <cstddef>
#include <string_view>

namespace importers {

// Inflates piece by piece, so that the plain bytes need not all be held.
class Inflater {
 public:
    // The bytes must outlive it; at most 4 GiB.
    explicit Inflater(std::string_view deflated) {
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(deflated.data()));
        stream_.avail_in = static_cast<uInt>(deflated.size());
        state_ = inflateInit(&stream_);
    }
    ~Inflater() { inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    // Writes the next `bytes` plain bytes. Returns how many: fewer if the deflated ones end or are damaged.
    size_t read(char* to, size_t bytes) {
        stream_.next_out = reinterpret_cast<Bytef*>(to);
        stream_.avail_out = static_cast<uInt>(bytes);
        while (state_ == Z_OK && stream_.avail_out > 0) state_ = inflate(&stream_, Z_NO_FLUSH);
        return bytes - stream_.avail_out;
    }

 private:
    z_stream stream_{};
    int state_ = Z_OK;
};

// Deflated bytes become 1032 times as many at most. Source: zlib's technical details, "Maximum Compression Factor".
inline constexpr unsigned kMostInflation = 1032;

}  // namespace importers
