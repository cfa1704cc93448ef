#include "render/emitters/map_mean.hpp"

#include <algorithm>
#include <cmath>

#include "base/pictures/shared_exponent.hpp"
#include "base/pictures/srgb.hpp"
#include "scene/bright_texture.hpp"

namespace clarity {
namespace {

constexpr double kMostSide = 8;  // texels of a side of the rectangle

// Where a coordinate beyond a picture of `size` texels shows it.
int64_t wrapped(int64_t at, int64_t size, rt_u32 mode) {
    if (mode == RT_WRAP_CLAMP) return std::clamp<int64_t>(at, 0, size - 1);
    const int64_t period = mode == RT_WRAP_MIRROR ? 2 * size : size, within = ((at % period) + period) % period;
    return within < size ? within : period - 1 - within;
}

double brightness(uint32_t texel, const rt_texture& texture) {
    double sum = 0;
    if (is_bright(texture)) {
        for (const float light : from_shared_exponent(texel)) sum += light;
        return sum / 3;
    }
    for (int k = 0; k < 3; ++k) {
        const auto byte = static_cast<uint8_t>(texel >> (8 * k));
        sum += texture.flags & RT_TEXTURE_LINEAR ? byte / 255.0 : linear_from_srgb(byte / 255.0);
    }
    return sum / 3;
}

}  // namespace

double mean_of_map(const Scene& scene, rt_u32 number, rt_u32 triangle) {
    const rt_map& map = scene.maps[number];
    const rt_texture& texture = scene.textures[map.texture];
    const SharedArray<float>& uvs = map.set == 0 ? scene.uvs : scene.uvs2;
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int corner = 0; corner < 3; ++corner) {
        const size_t vertex = scene.triangles[3 * size_t(triangle) + corner];
        const double u = uvs.empty() ? 0 : uvs[2 * vertex], v = uvs.empty() ? 0 : uvs[2 * vertex + 1];
        const double at[2] = {map.matrix[0] * u + map.matrix[1] * v + map.matrix[2],
                              1 - (map.matrix[3] * u + map.matrix[4] * v + map.matrix[5])};
        for (int k = 0; k < 2; ++k) lo[k] = std::min(lo[k], at[k]), hi[k] = std::max(hi[k], at[k]);
    }
    // The rectangle in texels of the picture that is small enough.
    rt_texture picture = texture;
    for (rt_u32 level = 0; level < texture.levels; ++level) {
        if ((hi[0] - lo[0]) * picture.width <= kMostSide && (hi[1] - lo[1]) * picture.height <= kMostSide) break;
        picture = smaller_picture(picture);
    }
    const uint32_t* const texels = scene.texels.data() + picture.first;
    const int64_t width = picture.width, height = picture.height, size[2] = {width, height};
    int64_t first[2], count[2];
    for (int k = 0; k < 2; ++k) {
        // Half a texel more, because colours are interpolated. Where the picture repeats, once is enough.
        first[k] = static_cast<int64_t>(std::floor(std::clamp(lo[k], -1e6, 1e6) * double(size[k]) - 0.5));
        const auto end = static_cast<int64_t>(std::floor(std::clamp(hi[k], -1e6, 1e6) * double(size[k]) + 0.5));
        count[k] = std::min(end - first[k] + 1, 2 * size[k]);
    }
    double sum = 0;
    for (int64_t y = 0; y < count[1]; ++y)
        for (int64_t x = 0; x < count[0]; ++x)
            sum += brightness(texels[wrapped(first[1] + y, height, texture.wrap / RT_WRAP_ALONG_V) * width +
                                     wrapped(first[0] + x, width, texture.wrap % RT_WRAP_ALONG_V)],
                              texture);
    return sum / (double(count[0]) * double(count[1]));
}

}  // namespace clarity
