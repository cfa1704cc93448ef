#include "render/film/png_text.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdint>

namespace clarity {
namespace {

// Signature, and the chunk IHDR, which is always the first: length, name, 13 bytes, checksum.
constexpr size_t kBehindHeader = 8 + 4 + 4 + 13 + 4;

std::string big_endian(uint32_t value) {
    return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
}

std::string chunk(const std::string& name, const std::string& data) {
    const std::string checked = name + data;
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
    return big_endian(static_cast<uint32_t>(data.size())) + checked + big_endian(static_cast<uint32_t>(sum));
}

}  // namespace

void add_png_texts(std::string& png, const std::vector<std::pair<std::string, std::string>>& texts) {
    std::string chunks;
    for (const auto& [key, value] : texts) {
        const bool ascii = std::all_of(value.begin(), value.end(), [](char c) { return c >= ' ' && c <= '~'; });
        // iTXt: no compression, no language, no translated key.
        chunks += ascii ? chunk("tEXt", key + '\0' + value) : chunk("iTXt", key + std::string(5, '\0') + value);
    }
    if (png.size() > kBehindHeader) png.insert(kBehindHeader, chunks);
}

}  // namespace clarity
