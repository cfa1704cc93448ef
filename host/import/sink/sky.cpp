// The sky of a scene: what importers say of it, and its picture.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/parallel_for.hpp"
#include "base/pictures/picture_read.hpp"
#include "base/pictures/srgb.hpp"
#include "base/problem.hpp"
#include "base/text.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/sink/texture.hpp"
#include "plugin/abi_struct.hpp"
#include "scene/bright_texture.hpp"
#include "scene/sky.hpp"
#include "scene/usable.hpp"
#include "scene/vec.hpp"

namespace clarity::import {
namespace {

// A sky from the six pictures of a cube.

// A square picture, RGBA8, top row first, as rt_sky_desc::faces has it; or the light itself (scene/bright_texture.hpp).
struct CubeFace {
    rt_texture picture{};
    std::vector<uint32_t> texels;
};
using Cube = std::array<CubeFace, 6>;

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
            if (is_bright(cube[f].picture)) {
                faces[f].push_back(bright_light(cube[f].picture, texel));
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

// Makes the picture of a sky from faces that are all as large. turn: a unit quaternion x, y, z, w. At most 4096 x 2048 texels.
// Each texel is the mean of 2 x 2 directions.
void show_cube(const Cube& cube, const std::array<double, 4>& turn, Sky& sky) {
    const Faces faces = decoded(cube);
    const rt_u32 side = cube[0].picture.width, width = std::clamp<rt_u32>(4 * side, 8, 4096), height = width / 2;
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

// The unit quaternion of a description; none if it has no length.
std::array<double, 4> turn_of(const rt_sky_desc& d) {
    double length = 0;
    for (const float x : d.turn) length += double(x) * x;
    if (!are_usable(d.turn) || !(length > 1e-12)) return {0, 0, 0, 1};
    const double scale = 1 / std::sqrt(length);
    return {d.turn[0] * scale, d.turn[1] * scale, d.turn[2] * scale, d.turn[3] * scale};
}

}  // namespace

// Whether there is a sky. Warns if a face is missing.
bool SceneBuilder::take_faces(const std::string& path, const rt_sky_desc& d, Sky& sky) {
    sky.file = d.path ? d.path : "a cube";
    const auto missing = [&](const std::string& why) {
        warn(path, "sky '" + sky.file + "': " + why + "; the background takes its place");
        return false;
    };
    Cube cube;
    for (size_t i = 0; i < 6; ++i) {
        if (!d.faces[i]) return missing("it has less than 6 faces");
        const rt_texture_desc face = copied<rt_texture_desc>(d.faces[i], d.faces[i]->struct_bytes);
        std::string content;
        if (face.path) {
            const FileAccess::Found found = access_.find_texture(path, face.path);
            if (found.path.empty()) return missing(std::string("'") + face.path + "': " + found.why);
            if (const Problem why = try_read_file(found.path, kMaxPictureFileBytes, content)) return missing(why.text());
        }
        const uint8_t* const bytes = face.path ? reinterpret_cast<const uint8_t*>(content.data()) : face.bytes;
        rt_texture& picture = cube[i].picture;
        std::string lost;
        if (const Problem why =
                decode_texture(bytes, face.path ? content.size() : face.byte_count, cube[i].texels, picture, lost))
            return missing("face " + std::to_string(i) + ": " + why.text());
        if (picture.width != picture.height || picture.width != cube[0].picture.width)
            return missing("face " + std::to_string(i) + " has " + std::to_string(picture.width) + " x " +
                           std::to_string(picture.height) + " texels; faces are squares of one size");
    }
    show_cube(cube, turn_of(d), sky);
    return true;
}

Problem SceneBuilder::set_sky(const std::string& path, const rt_sky_desc& d) {
    if (scene_.sky.values.kind != RT_NONE) return {};
    if (d.kind >= RT_SKY_KINDS) return "kind " + std::to_string(d.kind) + " is unknown";
    const float numbers[2] = {d.rotate_deg, d.strength};
    if (!are_usable(numbers) || !are_usable(d.color) || !are_usable(d.horizon) || !are_usable(d.ground))
        return "it holds numbers that are not finite";
    Sky sky;
    SkyValues& values = sky.values;
    values.kind = d.kind;
    values.hidden = d.hidden != 0;
    values.rotate_deg = static_cast<float>(std::remainder(double(d.rotate_deg), 360.0));
    values.strength = std::max(d.strength, 0.f);
    for (int k = 0; k < 3; ++k) {
        values.color[k] = std::max(d.color[k], 0.f);
        values.horizon[k] = std::max(d.horizon[k], 0.f);
        values.ground[k] = std::max(d.ground[k], 0.f);
    }
    if (d.kind == RT_SKY_PICTURE && d.faces[0]) {
        if (!take_faces(path, d, sky)) return {};
    } else if (d.kind == RT_SKY_PICTURE) {
        if (!d.path) return "a picture without a path";
        sky.file = d.path;
        const auto missing = [&](const std::string& why) {
            warn(path, "sky '" + sky.file + "': " + why + "; the background takes its place");
            return std::string();
        };
        const FileAccess::Found found = access_.find_texture(path, sky.file);
        if (found.path.empty()) return missing(found.why);
        try {
            const FloatImage image = read_picture(found.path);
            if (image.pixels.size() * sizeof(float) > kMaxTexelBytes)
                return missing("its texels would take more than " + memory_limit_text(kMaxTexelBytes));
            values.width = image.width;
            values.height = image.height;
            std::vector<float> texels(image.pixels.begin(), image.pixels.end());
            const std::string changed = make_sound_light(texels.data(), texels.size());
            if (!changed.empty()) warn(path, "sky '" + sky.file + "': " + changed);
            sky.texels = std::move(texels);
        } catch (const Error& e) {
            return missing(e.what());
        }
    }
    scene_.sky = std::move(sky);
    return {};
}

}  // namespace clarity::import
