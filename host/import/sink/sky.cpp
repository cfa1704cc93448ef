// The sky of a scene: what importers say of it, and its picture.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/memory_text.hpp"
#include "base/pictures/picture_read.hpp"
#include "base/problem.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/sink/texture.hpp"
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

}  // namespace

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
    if (d.kind == RT_SKY_PICTURE) {
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
