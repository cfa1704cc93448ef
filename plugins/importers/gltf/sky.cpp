// sky.cpp -- EXT_lights_image_based: the pictures of a cube that light the scene that is shown.
#include <algorithm>
#include <memory>

#include "maps.hpp"
#include "nodes.hpp"
#include "rt_plugin.hpp"
#include "tolerant.hpp"

namespace gltf_import {
namespace {

constexpr const char* kImageBased = "EXT_lights_image_based";

// The first six pictures are what mirrors show, the others blurred ones for rough surfaces, which the host needs as little as
// the irradiance: both follow from the first six.
void add_cube(const Document& document, const Value& light, Accessors& accessors, const rt_scene_sink& sink) {
    const Value images = spared_list(document, "images", sink), levels = light["specularImages"];
    if (levels.size() == 0 || levels[size_t(0)].size() != 6) levels.refuse("at least one list of 6 images");
    rt_sky_desc out{};
    out.struct_bytes = sizeof out;
    out.kind = RT_SKY_PICTURE;
    out.path = kImageBased;
    out.strength = static_cast<float>(std::clamp(light.number("intensity", 1), 0.0, 1e6));
    std::fill_n(out.color, 3, 1.0f);
    const std::array<double, 4> turn = light.numbers<4>("rotation", {0, 0, 0, 1});
    for (size_t k = 0; k < 4; ++k) out.turn[k] = static_cast<float>(turn[k]);
    std::vector<std::unique_ptr<Image>> faces;
    for (size_t i = 0; i < 6; ++i) {
        faces.push_back(std::make_unique<Image>(images[levels[size_t(0)][i].index(images)], accessors, document.folder()));
        out.faces[i] = &faces[i]->look;
    }
    sink.sky(sink.ctx, &out);
    if (levels.size() > 1 || light.has("irradianceCoefficients"))
        rt::warn(sink, std::string(kImageBased) +
                           ": the sharpest pictures are the sky; the blurred ones and the irradiance are "
                           "left out, because `path` finds both by itself");
}

}  // namespace

void add_sky(const Document& document, Accessors& accessors, const rt_scene_sink& sink) {
    if (!RT_HAS(&sink, rt_scene_sink, map_kind)) return;  // an older host knows no faces
    spared(sink, "the file's light from all around is left out", [&] {
        const Value scenes = document.list("scenes");
        if (scenes.size() == 0) return;
        const Value own = scenes[document.root().index("scene", scenes).value_or(0)].object("extensions").object(kImageBased);
        if (!own.has("light")) return;
        const Value lights = document.root().object("extensions").object(kImageBased).list("lights");
        add_cube(document, lights[own["light"].index(lights)], accessors, sink);
    });
}

}  // namespace gltf_import
