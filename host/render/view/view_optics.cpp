#include "render/view/view_optics.hpp"

#include <algorithm>
#include <iterator>

#include "render/settings/tracer_choice.hpp"
#include "scene/emissive.hpp"
#include "scene/surface_models.hpp"
#include "scene/vec.hpp"

namespace clarity {
namespace {

void add(Optics& optics, const rt_light& light) {
    optics.lights |= 1u << light.kind;
    if (light.flags & RT_LIGHT_FALLOFF) optics.lights |= RT_LIGHTS_FADE;
}

// A map may make any value smaller: a metal of 1 may have parts that are none, and let light through.
rt_u32 lobes_of_layers(const MaterialValues& m, const MaterialMaps& maps) {
    const rt_layers& l = m.layers;
    const bool clear = l.transmission > 0, solid = (l.flags & RT_LAYERS_SOLID) != 0;
    rt_u32 lobes = RT_LOBE_LAYERS;
    if (l.clearcoat > 0) lobes |= RT_LOBE_COAT;
    if (!is_black(l.sheen_color)) lobes |= RT_LOBE_SHEEN;
    if (clear && !solid) lobes |= RT_LOBE_THIN;
    if (clear && solid) lobes |= m.roughness > 0 || l.anisotropy > 0 ? RT_LOBE_GLASS | RT_LOBE_FROSTED : RT_LOBE_GLASS;
    if (l.anisotropy > 0) lobes |= RT_LOBE_GRAIN;
    if (l.iridescence > 0) lobes |= RT_LOBE_FILM;
    const bool is_white = std::all_of(l.specular_color, l.specular_color + 3, [](float c) { return c == 1; });
    const bool is_plain =
        l.specular_weight == 1 && is_white && maps[RT_MAP_SPECULAR] == RT_NONE && maps[RT_MAP_SPECULAR_COLOR] == RT_NONE;
    if (clear && solid && (!is_plain || l.iridescence > 0)) lobes |= RT_LOBE_CHANGED;
    return lobes;
}

void add(Optics& optics, const MaterialValues& m, const Material& own) {
    if (!own.used) return;
    if (emits(m)) optics.lights |= 1u << RT_EMITTER_SURFACE;
    rt_u32 lobes = 0;
    switch (m.model) {
        case RT_MODEL_WHITTED:
            if (m.reflect > 0) lobes |= RT_LOBE_MIRROR;
            if (m.refract > 0) lobes |= RT_LOBE_GLASS;
            break;
        case RT_MODEL_CONDUCTOR:
            lobes |= RT_LOBE_METAL;
            break;
        case RT_MODEL_DIELECTRIC:
            lobes |= RT_LOBE_GLASS;
            if (m.roughness > 0) lobes |= RT_LOBE_FROSTED;
            break;
        case RT_MODEL_GLTF:
            lobes |= lobes_of_layers(m, own.maps);
            break;
        case RT_MODEL_UNLIT:
            lobes |= RT_LOBE_UNLIT;
            break;
        default:
            if (is_surface_model(m.model)) lobes |= lobe_of_surface(m.model);
    }
    if ((lobes & RT_LOBE_GLASS) && !is_black(m.absorption)) lobes |= RT_LOBE_ABSORBS;
    optics.lobes |= lobes;
    if (m.alpha != RT_ALPHA_OPAQUE) optics.cutouts = 1;
}

Optics seen_by(const Settings& settings, const Optics& optics) {
    return picture_of_tracer(settings.tracer) == kPathPicture ? optics : optics.for_whitted();
}

Optics optics_of_sky(const SkyValues& sky, const std::array<float, 3>& background) {
    const bool shines = sky.kind != RT_NONE || std::any_of(background.begin(), background.end(), [](float c) { return c > 0; });
    return {shines ? 1u << RT_EMITTER_SKY : 0u, 0, 0};
}

}  // namespace

Optics optics_of(const Scene& scene) {
    Optics optics = optics_of_sky(scene.sky.values, scene.background);
    for (const Light& light : scene.lights) add(optics, light.values);
    if (scene.lights.empty()) optics.lights |= 1u << RT_LIGHT_POINT;  // those that make_view() adds
    for (const Material& material : scene.materials) add(optics, material.values, material);
    return optics;
}

Optics optics_of(const Scene& scene, const View& view, const Settings& settings) {
    Optics optics = optics_of_sky(sky_of(scene, view), view.background);
    for (const rt_light& light : view.lights) add(optics, light);
    for (size_t i = 0; i < scene.materials.size(); ++i) add(optics, material_of(scene, view, i), scene.materials[i]);
    return seen_by(settings, optics);
}

bool knows(const Settings& prepared, const Scene& scene, const View& view) {
    return seen_by(prepared, optics_of(scene) | prepared.optics).covers(optics_of(scene, view, prepared));
}

Settings with_optics(Settings settings, const Scene& scene, const View& view) {
    settings.optics = optics_of(scene, view, settings);
    return settings;
}

}  // namespace clarity
