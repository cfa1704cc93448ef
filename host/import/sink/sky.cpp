// The sky of a scene: what importers say of it, and its picture.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/memory_text.hpp"
#include "base/pictures/picture_read.hpp"
#include "base/problem.hpp"
#include "import/sink/cube_sky.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/sink/texture.hpp"
#include "plugin/abi_struct.hpp"
#include "scene/bright_texture.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

// Radiance is finite and not negative. Returns how many numbers were not.
size_t make_sound(std::vector<float>& texels) {
    size_t repaired = 0;
    for (float& texel : texels) {
        if (is_usable(texel) && texel >= 0) continue;
        texel = 0;
        ++repaired;
    }
    return repaired;
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
        rt_texture picture{};
        std::string lost;
        if (const Problem why =
                decode_texture(bytes, face.path ? content.size() : face.byte_count, cube[i].texels, picture, lost))
            return missing("face " + std::to_string(i) + ": " + why.text());
        cube[i].is_bright = clarity::is_bright(picture);
        cube[i].side = picture.width;
        if (picture.width != picture.height || cube[i].side != cube[0].side)
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
            if (const size_t repaired = make_sound(texels))
                warn(path, "sky '" + sky.file + "': " + std::to_string(repaired) +
                               " of its numbers are negative or not finite; they count as 0");
            sky.texels = std::move(texels);
        } catch (const Error& e) {
            return missing(e.what());
        }
    }
    scene_.sky = std::move(sky);
    return {};
}

}  // namespace clarity::import
