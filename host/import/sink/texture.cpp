#include "import/sink/texture.hpp"

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

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "base/parallel_for.hpp"
#include "base/pictures/light_range.hpp"
#include "base/pictures/picture_read.hpp"
#include "base/pictures/shared_exponent.hpp"
#include "base/pictures/srgb.hpp"
#include "base/text.hpp"
#include "rt_plugin.h"
#include "scene/bright_texture.hpp"
#include "scene/usable.hpp"

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

Problem decode_floats(const std::string& bytes, std::vector<uint32_t>& texels, rt_texture& texture, std::string& lost) {
    try {
        const std::array<unsigned, 2> size = size_of_floats(bytes);
        if (Problem why = check_size(size[0], size[1], texels)) return why;
        FloatImage image = decode_picture(bytes);
        const size_t count = size_t(image.width) * image.height;
        lost = make_sound_light(image.pixels.data(), 3 * count);
        LightRange light;  // of the brightest channels, which the others share their exponent with
        for (size_t i = 0; i < count; ++i) {
            const float* const rgb = &image.pixels[3 * i];
            light.add(std::max({rgb[0], rgb[1], rgb[2]}));
        }
        const int power = power_that_fits(light, {kDarkestShared, kBrightestShared});
        texture = {static_cast<rt_u32>(texels.size()), image.width, image.height, 0, bright_flags(power), 0, 0};
        texels.resize(texture.first + count);
        for (size_t i = 0; i < count; ++i) {
            float rgb[3];
            for (size_t k = 0; k < 3; ++k) rgb[k] = std::ldexp(image.pixels[3 * i + k], -power);
            texels[texture.first + i] = to_shared_exponent(rgb);
        }
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

constexpr double kHeight = 1.0 / 50;  // of white above black, in widths of the picture
constexpr int kGrey = 8;              // by which channels of a grey texel may differ, as JPEG has them

int channel(uint32_t texel, int k) {
    return static_cast<int>(texel >> (8 * k) & 255u);
}
bool is_grey(uint32_t texel) {
    return std::abs(channel(texel, 0) - channel(texel, 1)) <= kGrey && std::abs(channel(texel, 1) - channel(texel, 2)) <= kGrey;
}
uint32_t byte_of(double component) {
    return static_cast<uint32_t>(std::lround((component + 1) / 2 * 255));
}

constexpr int kFine = 4096;  // steps of linear light, for the way back to sRGB

struct Curves {
    Curves() {
        for (int i = 0; i < 256; ++i) linear[i] = static_cast<float>(linear_from_srgb(i / 255.0));
        for (int i = 0; i <= kFine; ++i) byte[i] = static_cast<float>(255 * srgb_from_linear(double(i) / kFine));
    }
    // The byte of linear light. Near 0 the curve is straight, or nearly so, between two steps.
    uint32_t byte_of(float light) const {
        const float at = std::clamp(light, 0.f, 1.f) * kFine;
        const int below = std::min(static_cast<int>(at), kFine - 1);
        const float share = at - static_cast<float>(below);
        return static_cast<uint32_t>(byte[below] + share * (byte[below + 1] - byte[below]) + 0.5f);
    }
    std::array<float, 256> linear;
    std::array<float, kFine + 1> byte;
};

// Along one axis: up to three texels of `size` that a texel of the `half` ones covers, and their shares.
struct Cover {
    rt_u32 first = 0, count = 0;
    float share[3] = {0, 0, 0};
};
std::vector<Cover> covers(rt_u32 size, rt_u32 half) {
    std::vector<Cover> out(half);
    for (rt_u32 i = 0; i < half; ++i) {
        const double begin = double(i) * size / half, end = double(i + 1) * size / half;
        Cover& c = out[i];
        c.first = static_cast<rt_u32>(begin);
        for (rt_u32 at = c.first; at < size && double(at) < end - 1e-9 && c.count < 3; ++at)
            c.share[c.count++] =
                static_cast<float>((std::min(end, at + 1.0) - std::max(begin, double(at))) * half / double(size));
    }
    return out;
}

// Texels of bytes, and of bright textures: how a share of one is added to a sum, and what a sum becomes.
struct ByteTexels {
    bool is_linear;
    const Curves& curves;
    void add(float share, uint32_t texel, float (&sum)[4]) const {
        for (int k = 0; k < 4; ++k) {
            const uint32_t byte = texel >> (8 * k) & 255u;
            sum[k] += share * (is_linear || k == 3 ? static_cast<float>(byte) / 255 : curves.linear[byte]);
        }
    }
    uint32_t texel(const float (&sum)[4]) const {
        uint32_t out = 0;
        for (int k = 0; k < 4; ++k) {
            const bool plain = is_linear || k == 3;
            out |= (plain ? static_cast<uint32_t>(std::clamp(sum[k], 0.f, 1.f) * 255 + 0.5f) : curves.byte_of(sum[k]))
                   << (8 * k);
        }
        return out;
    }
};
// Without the texture's power of two, which smaller pictures have, too.
struct BrightTexels {
    void add(float share, uint32_t texel, float (&sum)[4]) const {
        const std::array<float, 3> light = from_shared_exponent(texel);
        for (size_t k = 0; k < 3; ++k) sum[k] += share * light[k];
    }
    uint32_t texel(const float (&sum)[4]) const { return to_shared_exponent(sum); }
};

template <class Kind>
void add_smaller(const Kind& kind, std::vector<uint32_t>& texels, rt_texture& texture) {
    rt_texture from = texture;
    while (from.width > 1 || from.height > 1) {
        const rt_texture to = smaller_picture(from);
        texels.resize(to.first + size_t(to.width) * to.height);
        const std::vector<Cover> columns = covers(from.width, to.width), rows = covers(from.height, to.height);
        parallel_for(to.height, [&](uint32_t y) {
            for (rt_u32 x = 0; x < to.width; ++x) {
                float sum[4] = {0, 0, 0, 0};
                for (rt_u32 j = 0; j < rows[y].count; ++j)
                    for (rt_u32 i = 0; i < columns[x].count; ++i) {
                        const uint32_t texel =
                            texels[from.first + size_t(rows[y].first + j) * from.width + columns[x].first + i];
                        kind.add(rows[y].share[j] * columns[x].share[i], texel, sum);
                    }
                texels[to.first + size_t(y) * to.width + x] = kind.texel(sum);
            }
        });
        from = to;
        ++texture.levels;
    }
}

}  // namespace

std::string make_sound_light(float* numbers, size_t count) {
    size_t unsound = 0, too_bright = 0;
    for (size_t i = 0; i < count; ++i) {
        const bool is_sound = numbers[i] >= 0 && std::isfinite(numbers[i]);
        const float kept = is_sound ? std::min(numbers[i], kMostCoordinate) : 0;
        unsound += !is_sound;
        too_bright += is_sound && kept < numbers[i];
        numbers[i] = kept;
    }
    std::string changed;
    if (unsound > 0) changed = std::to_string(unsound) + " of its numbers are negative or not finite; they count as 0";
    if (too_bright > 0)
        changed +=
            (changed.empty() ? "" : "; ") + std::to_string(too_bright) + " of its numbers are above 1e15, where light ends";
    return changed;
}

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
        const std::array<float, 3> rgb = bright_light(texture, texels[i]);
        const auto byte = [&](size_t k) { return static_cast<uint32_t>(std::min(rgb[k], 1.0f) * 255 + 0.5f); };
        texels[i] = byte(0) | byte(1) << 8 | byte(2) << 16 | 0xff000000u;
    }
    texture.flags &= ~(kBrightTexture | kBrightPower);
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

void make_normals(uint32_t* texels, const rt_texture& picture) {
    const size_t width = picture.width, height = picture.height, count = width * height;
    const auto grey = static_cast<size_t>(std::count_if(texels, texels + count, is_grey));
    if (grey < count - count / 8) return;
    std::vector<uint8_t> heights(count);
    for (size_t i = 0; i < count; ++i) heights[i] = static_cast<uint8_t>(channel(texels[i], 0));
    const double step = kHeight * static_cast<double>(width) / 255 / 2;  // of a byte over two texels
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x) {
            // Pictures repeat. Rows go downwards, and the normal's y upwards.
            const auto at = [&](size_t column, size_t row) { return double(heights[row % height * width + column % width]); };
            const double dx = step * (at(x + 1, y) - at(x + width - 1, y)), dy = step * (at(x, y + height - 1) - at(x, y + 1));
            const double scale = 1 / std::sqrt(dx * dx + dy * dy + 1);
            texels[y * width + x] = 0xff000000u | byte_of(-dx * scale) | byte_of(-dy * scale) << 8 | byte_of(scale) << 16;
        }
}

void make_opacities(uint32_t* texels, const rt_texture& picture, uint32_t space) {
    for (size_t i = 0; i < size_t(picture.width) * picture.height; ++i) {
        const auto at = [&](unsigned k) { return texels[i] >> (8 * k) & 255u; };
        // COLLADA 1.5, RGB_ZERO: luminance by weights of its own.
        const double brightness = 0.2127 * at(0) + 0.7152 * at(1) + 0.0721 * at(2);
        const uint32_t opacity = space == RT_SPACE_ALPHA ? at(3) : static_cast<uint32_t>(std::lround(255 - brightness));
        texels[i] = opacity * 0x01010101u;
    }
}

void add_smaller_pictures(std::vector<uint32_t>& texels, rt_texture& texture) {
    static const Curves curves;
    if (is_bright(texture))
        add_smaller(BrightTexels{}, texels, texture);
    else
        add_smaller(ByteTexels{(texture.flags & RT_TEXTURE_LINEAR) != 0, curves}, texels, texture);
}

}  // namespace clarity::import
