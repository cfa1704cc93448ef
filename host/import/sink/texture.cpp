#include "import/sink/texture.hpp"

#include <climits>
#include <cstring>
#include <memory>

// Static, because the window's libraries may contain their own copy of stb_image.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>

#include "base/memory_text.hpp"
#pragma GCC diagnostic pop

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

}  // namespace

Problem decode_texture(const uint8_t* bytes, uint64_t byte_count, std::vector<uint32_t>& texels, rt_texture& texture) {
    if (byte_count > INT_MAX) return "the picture has more than 2 GiB";
    const int count = static_cast<int>(byte_count);
    int width = 0, height = 0, channels = 0;
    const auto reason = [] { return std::string(stbi_failure_reason() ? stbi_failure_reason() : "unknown format"); };
    if (!stbi_info_from_memory(bytes, count, &width, &height, &channels))
        return "its format is not supported (PNG, JPEG, BMP, TGA, PSD, GIF, HDR and PNM are): " + reason();
    if (Problem why = check_size(static_cast<uint64_t>(width), static_cast<uint64_t>(height), texels)) return why;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(stbi_load_from_memory(bytes, count, &width, &height, &channels, 4),
                                                           stbi_image_free);
    if (!pixels) return "the picture is damaged: " + reason();
    append(pixels.get(), static_cast<rt_u32>(width), static_cast<rt_u32>(height), texels, texture);
    return {};
}

bool loses_light(const uint8_t* bytes, uint64_t byte_count) {
    return byte_count <= INT_MAX && stbi_is_hdr_from_memory(bytes, static_cast<int>(byte_count));
}

uint64_t memory_of_texture(const uint8_t* bytes, uint64_t byte_count) {
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
