#include "import/sink/texture.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <memory>

// Static, because the window's libraries may contain their own copy of stb_image.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>

#pragma GCC diagnostic pop

#include "base/memory_text.hpp"
#include "base/pictures/picture_read.hpp"
#include "base/pictures/shared_exponent.hpp"
#include "scene/bright_texture.hpp"

namespace clarity::import {
namespace {

// Returns nothing if a picture of this size may still be added, otherwise why not.
Problem check_size(uint64_t width, uint64_t height, const std::vector<uint32_t>& texels) {
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    if (width == 0 || height == 0) return size + ": it is empty";
    if (width > kMaxTextureSide || height > kMaxTextureSide) {
        return size + ": at most " + std::to_string(kMaxTextureSide) + " are possible along each side";
    }
    // Smaller pictures take a third more, and a row each where a side is odd.
    if (4 * (texels.size() + width * height / 3 * 4 + width + height + 16) > kMaxTexelBytes) {
        return size + ": the scene's textures would take more than " + memory_limit_text(kMaxTexelBytes) +
               "; make pictures smaller";
    }
    return {};
}

void append(const void* rgba, rt_u32 width, rt_u32 height, std::vector<uint32_t>& texels, rt_texture& texture) {
    texture = {static_cast<rt_u32>(texels.size()), width, height, 0, 0, 0, 0};
    texels.resize(texels.size() + size_t(width) * height);
    std::memcpy(texels.data() + texture.first, rgba, 4 * size_t(width) * height);
}

// The beginning of a file tells a picture of floats. Their reader wants all of it as text.
bool holds_floats(const uint8_t* bytes, uint64_t byte_count) {
    return clarity::holds_floats(
        {reinterpret_cast<const char*>(bytes), static_cast<size_t>(std::min<uint64_t>(byte_count, 4))});
}
std::string as_text(const uint8_t* bytes, uint64_t byte_count) {
    return {reinterpret_cast<const char*>(bytes), static_cast<size_t>(byte_count)};
}

// Radiance is finite and not negative.
Problem decode_floats(const std::string& bytes, std::vector<uint32_t>& texels, rt_texture& texture, std::string& lost) {
    try {
        const std::array<unsigned, 2> size = size_of_floats(bytes);
        if (Problem why = check_size(size[0], size[1], texels)) return why;
        const FloatImage image = decode_picture(bytes);
        texture = {static_cast<rt_u32>(texels.size()), image.width, image.height, 0, kBrightTexture, 0, 0};
        const size_t count = size_t(image.width) * image.height;
        texels.resize(texture.first + count);
        size_t unsound = 0, too_bright = 0;
        for (size_t i = 0; i < count; ++i) {
            float rgb[3];
            for (size_t k = 0; k < 3; ++k) {
                const float x = image.pixels[3 * i + k];
                const bool is_sound = x >= 0 && std::isfinite(x);
                unsound += !is_sound;
                too_bright += is_sound && x > kBrightestShared;
                rgb[k] = is_sound ? x : 0;
            }
            texels[texture.first + i] = to_shared_exponent(rgb);
        }
        if (unsound > 0) lost = std::to_string(unsound) + " of its numbers are negative or not finite; they count as 0";
        if (too_bright > 0)
            lost +=
                (lost.empty() ? "" : "; ") + std::to_string(too_bright) + " of its numbers are above 65408, where light ends";
        return {};
    } catch (const std::exception& e) {
        return "the picture cannot be read: " + std::string(e.what());
    }
}

// Bytes of a picture of floats, while it is decoded: the file twice, and two copies of its floats.
uint64_t memory_of_floats(const std::string& bytes) {
    try {
        const std::array<unsigned, 2> size = size_of_floats(bytes);
        const uint64_t texels = uint64_t(std::min(size[0], kMaxTextureSide)) * std::min(size[1], kMaxTextureSide);
        return 2 * bytes.size() + texels * (2 * 3 * sizeof(float) + 16);
    } catch (const std::exception&) {
        return 0;
    }
}

}  // namespace

Problem decode_texture(const uint8_t* bytes, uint64_t byte_count, std::vector<uint32_t>& texels, rt_texture& texture,
                       std::string& lost) {
    lost.clear();
    if (byte_count > INT_MAX) return "the picture has more than 2 GiB";
    if (holds_floats(bytes, byte_count)) return decode_floats(as_text(bytes, byte_count), texels, texture, lost);
    const int count = static_cast<int>(byte_count);
    int width = 0, height = 0, channels = 0;
    const auto reason = [] { return std::string(stbi_failure_reason() ? stbi_failure_reason() : "unknown format"); };
    if (!stbi_info_from_memory(bytes, count, &width, &height, &channels))
        return "its format is not supported (PNG, JPEG, BMP, TGA, PSD, GIF, HDR, EXR, PFM and PNM are): " + reason();
    if (Problem why = check_size(static_cast<uint64_t>(width), static_cast<uint64_t>(height), texels)) return why;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(stbi_load_from_memory(bytes, count, &width, &height, &channels, 4),
                                                           stbi_image_free);
    if (!pixels) return "the picture is damaged: " + reason();
    append(pixels.get(), static_cast<rt_u32>(width), static_cast<rt_u32>(height), texels, texture);
    return {};
}

void make_bytes(std::vector<uint32_t>& texels, rt_texture& texture) {
    for (size_t i = texture.first; i < texels.size(); ++i) {
        const std::array<float, 3> rgb = from_shared_exponent(texels[i]);
        const auto byte = [&](size_t k) { return static_cast<uint32_t>(std::min(rgb[k], 1.0f) * 255 + 0.5f); };
        texels[i] = byte(0) | byte(1) << 8 | byte(2) << 16 | 0xff000000u;
    }
    texture.flags &= ~kBrightTexture;
}

uint64_t memory_of_texture(const uint8_t* bytes, uint64_t byte_count) {
    if (holds_floats(bytes, byte_count)) return memory_of_floats(as_text(bytes, byte_count));
    int width = 0, height = 0, channels = 0;
    if (byte_count > INT_MAX || !stbi_info_from_memory(bytes, static_cast<int>(byte_count), &width, &height, &channels))
        return 0;
    // The decoder's two copies; and the texels, with a third more for smaller pictures, in an array that is at most half empty
    // and that is copied when it grows.
    const uint64_t texels = 4 * static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    return 2 * texels + 4 * (texels / 3 * 4);
}

Problem copy_texture(const uint8_t* bytes, uint64_t byte_count, rt_u32 width, rt_u32 height, std::vector<uint32_t>& texels,
                     rt_texture& texture) {
    if (Problem why = check_size(width, height, texels)) return why;
    if (byte_count < 4 * uint64_t(width) * height) return "its data in memory is shorter than its width and height need";
    append(bytes, width, height, texels, texture);
    return {};
}

}  // namespace clarity::import
