#include "import/sink/smaller_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel_for.hpp"
#include "base/pictures/shared_exponent.hpp"
#include "base/pictures/srgb.hpp"
#include "scene/bright_texture.hpp"

namespace clarity::import {
namespace {

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

void add_smaller_pictures(std::vector<uint32_t>& texels, rt_texture& texture) {
    static const Curves curves;
    if (is_bright(texture))
        add_smaller(BrightTexels{}, texels, texture);
    else
        add_smaller(ByteTexels{(texture.flags & RT_TEXTURE_LINEAR) != 0, curves}, texels, texture);
}

}  // namespace clarity::import
