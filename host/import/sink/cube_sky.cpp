#include "import/sink/cube_sky.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/parallel_for.hpp"
#include "base/pictures/shared_exponent.hpp"
#include "base/pictures/srgb.hpp"
#include "scene/vec.hpp"

namespace clarity::import {
namespace {

using Radiance = std::array<float, 3>;

// A view from within the cube. Columns of pictures go to its right, which is forward x up. Source: the table of cube maps in
// OpenGL 4.6, section 8.13, mirrored as glTF's EXT_lights_image_based says.
struct Side {
    Vec forward, up, right;
};
constexpr Side kSides[6] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},   {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
                            {{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}}, {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
                            {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},  {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}};

// The direction of the cube that is turned to d: d + 2 w (v x d) + 2 v x (v x d) by the conjugate.
Vec turned_back(const std::array<double, 4>& turn, const Vec& d) {
    const Vec v = {-turn[0], -turn[1], -turn[2]}, once = cross(v, d), twice = cross(v, once);
    return d + 2 * (turn[3] * once + twice);
}

// Faces as linear radiance.
using Faces = std::array<std::vector<Radiance>, 6>;
Faces decoded(const Cube& cube) {
    std::array<double, 256> linear{};
    for (size_t i = 0; i < 256; ++i) linear[i] = linear_from_srgb(double(i) / 255);
    Faces faces;
    for (size_t f = 0; f < 6; ++f)
        for (const uint32_t texel : cube[f].texels) {
            if (cube[f].is_bright) {
                faces[f].push_back(from_shared_exponent(texel));
                continue;
            }
            const double scale = 255.0 / std::max(1u, texel >> 24);
            faces[f].push_back({static_cast<float>(scale * linear[texel & 255]),
                                static_cast<float>(scale * linear[texel >> 8 & 255]),
                                static_cast<float>(scale * linear[texel >> 16 & 255])});
        }
    return faces;
}

// Bilinear within a face. Near an edge the outermost texels are shown, not those of the next face.
Radiance seen(const Faces& faces, rt_u32 side, const Vec& d) {
    size_t best = 0;
    for (size_t f = 1; f < 6; ++f)
        if (dot(d, kSides[f].forward) > dot(d, kSides[best].forward)) best = f;
    const double forward = dot(d, kSides[best].forward);
    const auto place = [&](double x) { return std::clamp((x / forward + 1) / 2 * side - 0.5, 0.0, double(side - 1)); };
    const double x = place(dot(d, kSides[best].right)), y = place(-dot(d, kSides[best].up));
    const size_t x0 = static_cast<size_t>(x), y0 = static_cast<size_t>(y), x1 = std::min<size_t>(x0 + 1, side - 1),
                 y1 = std::min<size_t>(y0 + 1, side - 1);
    Radiance out{};
    for (size_t k = 0; k < 3; ++k) {
        const auto at = [&](size_t column, size_t row) { return double(faces[best][row * side + column][k]); };
        const double u = x - double(x0), v = y - double(y0), upper = at(x0, y0) + u * (at(x1, y0) - at(x0, y0)),
                     lower = at(x0, y1) + u * (at(x1, y1) - at(x0, y1));
        out[k] = static_cast<float>(upper + v * (lower - upper));
    }
    return out;
}

}  // namespace

// Each texel is the mean of 2 x 2 directions.
void show_cube(const Cube& cube, const std::array<double, 4>& turn, Sky& sky) {
    const Faces faces = decoded(cube);
    const rt_u32 side = cube[0].side, width = std::clamp<rt_u32>(4 * side, 8, 4096), height = width / 2;
    sky.values.width = width;
    sky.values.height = height;
    std::vector<float> texels(size_t(3) * width * height);
    parallel_for(height, [&](uint32_t row) {
        for (rt_u32 column = 0; column < width; ++column) {
            float* const out = &texels[size_t(3) * (row * width + column)];
            for (int sample = 0; sample < 4; ++sample) {
                const double phi = ((column + (sample % 2 ? 0.75 : 0.25)) / width - 0.5) * 2 * kPi,
                             theta = (row + (sample / 2 ? 0.75 : 0.25)) / height * kPi, ring = std::sin(theta);
                const Vec d = {ring * std::cos(phi), std::cos(theta), ring * std::sin(phi)};
                const Radiance part = seen(faces, side, turned_back(turn, d));
                for (size_t k = 0; k < 3; ++k) out[k] += part[k] / 4;
            }
        }
    });
    sky.texels = std::move(texels);
}

}  // namespace clarity::import
