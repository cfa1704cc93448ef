#include "render/view/view.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "render/view/camera_text.hpp"
#include "scene/camera.hpp"
#include "scene/light_kinds.hpp"

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

}  // namespace clarity
