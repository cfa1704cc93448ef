#include "view/view.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "scene/camera.hpp"
#include "scene/emissive.hpp"
#include "scene/light_kinds.hpp"
#include "scene/surface_models.hpp"
#include "scene/vec.hpp"
#include "view/settings/settings.hpp"

namespace clarity {
namespace {

Camera camera_named(const Scene& scene, const std::string& text, float aspect) {
    if (text.empty()) return scene.cameras.empty() ? framing_camera(scene, aspect) : scene.cameras.front();
    for (const Camera& camera : scene.cameras)
        if (camera.name == text) return camera;
    const std::optional<CameraNumbers> numbers = read_camera_numbers(text);
    if (numbers && !numbers->up) {
        Camera camera;
        camera.name = "command line";
        camera.eye = scene_point(numbers->eye, scene.origin);
        camera.target = scene_point(numbers->target, scene.origin);
        const auto fov = static_cast<float>(numbers->fov_deg.value_or(45));
        if (fov <= 0 || fov >= 180)
            throw Error(Exit::usage, "--camera: a field of view of " + text.substr(text.rfind(',') + 1) +
                                         " degrees is not between 0 and 180");
        if (camera.eye == camera.target) throw Error(Exit::usage, "--camera: eye and target are the same point");
        camera.fov_y_rad = fov * static_cast<float>(kPi) / 180.0f;
        return camera;
    }
    std::string known;
    for (const Camera& camera : scene.cameras) known += (known.empty() ? "" : ", ") + camera.name;
    throw Error(Exit::usage, "--camera: `" + text + "` is neither ex,ey,ez,tx,ty,tz[,fov_degrees] nor a camera of the scene (" +
                                 (known.empty() ? "it has none" : known) + ")");
}

// For scenes without lights: a key light from the upper left behind the camera, and a weaker one from the right.
std::vector<rt_light> default_lights(const Scene& scene, const Camera& camera) {
    const Bounds bounds = scene.bounds();
    const float diagonal = bounds.empty ? 0 : bounds.diagonal(), size = diagonal > 0 ? diagonal : 1;
    std::array<float, 3> forward, right, up = camera.up;
    for (int k = 0; k < 3; ++k) forward[k] = camera.target[k] - camera.eye[k];
    right = {forward[1] * up[2] - forward[2] * up[1], forward[2] * up[0] - forward[0] * up[2],
             forward[0] * up[1] - forward[1] * up[0]};
    const float length = std::sqrt(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]);
    std::vector<rt_light> lights(2);
    for (int k = 0; k < 3; ++k) {
        const float side = length > 0 ? right[k] / length : 0;
        const float center = bounds.empty ? 0 : 0.5f * (bounds.min[k] + bounds.max[k]);
        lights[0].position[k] = camera.eye[k] + size * (0.6f * up[k] - 0.5f * side);
        lights[1].position[k] = center + size * (0.8f * up[k] + 1.2f * side);
        lights[0].color[k] = 0.75f;
        lights[1].color[k] = 0.35f;
    }
    for (rt_light& light : lights) light.flags = RT_LIGHT_STAND_IN;
    return lights;
}

bool has_lens(const Camera& camera) {
    return camera.aperture != 0 || camera.focus != 0;
}

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

View make_view(const Scene& scene, float aspect, const std::string& camera, const std::string& light) {
    View view;
    view.camera = camera_named(scene, camera, aspect);
    for (const Light& l : scene.lights) view.lights.push_back(l.values);
    if (view.lights.empty()) view.lights = default_lights(scene, view.camera);
    view.background = scene.background;
    view.ambient = scene.ambient;
    if (!light.empty()) {
        const std::vector<double> n = read_numbers<double>(light);
        if (n.size() != 3) throw Error(Exit::usage, "--light: `" + light + "` is not x,y,z");
        if (!light_kind_of(view.lights[0]).has_place) {
            rt_light point = default_light(RT_LIGHT_POINT);
            std::copy_n(view.lights[0].color, 3, point.color);
            view.lights[0] = point;
        }
        const std::array<float, 3> at = scene_point({n[0], n[1], n[2]}, scene.origin);
        std::copy(at.begin(), at.end(), view.lights[0].position);
        make_sound(view.lights[0], true);
    }
    return view;
}

std::string size_note(const std::vector<rt_light>& lights, const std::string& tracer) {
    const auto count = std::count_if(lights.begin(), lights.end(), [](const rt_light& l) { return light_kind_of(l).has_size; });
    if (count == 0 || picture_of_tracer(tracer) != kWhittedPicture) return {};
    return std::to_string(count) +
           (count == 1 ? " light with a size lights as a point at its middle"
                       : " lights with a size light as points at their middles") +
           ", without soft shadows, because the tracer `" + tracer + "` shades as Whitted does";
}

std::array<float, 3> scene_point(const std::array<double, 3>& in_file, const std::array<double, 3>& origin) {
    std::array<float, 3> point{};
    for (int k = 0; k < 3; ++k) point[k] = static_cast<float>(in_file[k] - origin[k]);
    return point;
}

std::string point_text(const float* in_scene, const std::array<double, 3>& origin, const char* between) {
    std::string text;
    for (int k = 0; k < 3; ++k)
        text += (k ? between : "") + (origin[k] == 0 ? exact_text(in_scene[k]) : exact_text(double(in_scene[k]) + origin[k]));
    return text;
}

std::optional<CameraNumbers> read_camera_numbers(const std::string& text) {
    const std::vector<float> n = read_numbers<float>(text);
    if (n.size() != 6 && n.size() != 7 && n.size() != 10 && n.size() != 12) return {};
    CameraNumbers camera;
    const std::vector<double> exact = read_numbers<double>(text);
    std::copy_n(exact.begin(), 3, camera.eye.begin());
    std::copy_n(exact.begin() + 3, 3, camera.target.begin());
    if (n.size() >= 7) camera.fov_deg = exact[6];
    if (n.size() >= 10) camera.up = {n[7], n[8], n[9]};
    if (n.size() == 12) camera.aperture = n[10], camera.focus = n[11];
    if (camera.aperture < 0 || camera.focus < 0) return {};
    return camera;
}

std::string camera_text(const Camera& camera, const std::array<double, 3>& origin) {
    return point_text(camera.eye.data(), origin, ",") + "," + point_text(camera.target.data(), origin, ",") + "," +
           exact_text(camera.fov_y_rad / kRadPerDegree) + "," + numbers_text(camera.up.data(), 3) +
           (has_lens(camera) ? "," + exact_text(camera.aperture) + "," + exact_text(camera.focus) : "");
}

std::string lens_words(const Camera& camera) {
    return has_lens(camera) ? "  aperture " + exact_text(camera.aperture) + "  focus " + exact_text(camera.focus) : "";
}

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
