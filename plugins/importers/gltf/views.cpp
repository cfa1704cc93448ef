// views.cpp -- cameras and lights.
#include <algorithm>
#include <cmath>

#include "nodes.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

// Applies the linear part to a vector and makes it unit. `otherwise` if its length is 0 or not finite.
std::array<float, 3> direction(const Transform& m, const std::array<double, 3>& v, const std::array<float, 3>& otherwise) {
    std::array<double, 3> r{};
    for (size_t row = 0; row < 3; ++row) r[row] = m[4 * row] * v[0] + m[4 * row + 1] * v[1] + m[4 * row + 2] * v[2];
    const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    if (!(length > 1e-30) || !std::isfinite(length)) return otherwise;
    return {float(r[0] / length), float(r[1] / length), float(r[2] / length)};
}

std::string label(const Value& value) {
    return value.has("name") ? in_quotes(value["name"].text()) : value.path();
}

}  // namespace

void add_cameras(const Document& document, const NodeTree& tree, const rt_scene_sink& sink) {
    const Value cameras = document.list("cameras");
    for (const size_t i : tree.shown()) {
        const auto index = tree.list()[i].index("camera", cameras);
        if (!index) continue;
        const Value camera = cameras[*index];
        const Transform& m = tree.placed(i);
        const std::string name = camera.text("name", tree.name(i));
        rt_camera out{};
        out.struct_bytes = sizeof out;
        out.name = name.c_str();
        out.node = tree.id(i);
        const std::array<float, 3> forward = direction(m, {0, 0, -1}, {0, 0, -1}), up = direction(m, {0, 1, 0}, {0, 1, 0});
        for (size_t k = 0; k < 3; ++k) {
            out.eye[k] = to_float(m[4 * k + 3]);
            out.target[k] = out.eye[k] + forward[k];
            out.up[k] = up[k];
        }
        double fov_y = camera.object("perspective").number("yfov", 0);
        if (!(fov_y > 0.001) || fov_y > 3.1) {
            rt::warn(sink, "the camera " + label(camera) + " has no angle of view (orthographic?): 45 degrees are used");
            fov_y = 0.7853982;
        }
        out.fov_y_rad = static_cast<float>(fov_y);
        rt::id(sink.camera(sink.ctx, &out));
    }
}

void add_lights(const Document& document, const NodeTree& tree, const rt_host* host, const rt_scene_sink& sink) {
    constexpr const char* kExtension = "KHR_lights_punctual";
    const Value lights = document.root().object("extensions").object(kExtension).list("lights");
    std::vector<rt_light_desc> placed;
    std::vector<std::string> names;
    float brightest = 0;
    for (const size_t i : tree.shown()) {
        const auto index = tree.list()[i].object("extensions").object(kExtension).index("light", lights);
        if (!index) continue;
        const Value light = lights[*index];
        const Transform& m = tree.placed(i);
        const std::string type = light["type"].text();
        if (type != "directional" && type != "point" && type != "spot")
            light["type"].refuse("'directional', 'point' or 'spot'");
        if (type == "spot") rt::warn(sink, "the spot light " + label(light) + " became a point light");
        rt_light_desc out{};
        out.struct_bytes = sizeof out;
        out.kind = type == "directional" ? RT_LIGHT_DIRECTIONAL : RT_LIGHT_POINT;
        out.node = tree.id(i);
        const std::array<float, 3> shines = direction(m, {0, 0, -1}, {0, -1, 0});
        const std::array<double, 3> color = light.numbers<3>("color", {1, 1, 1});
        const double intensity = light.number("intensity", 1);
        for (size_t k = 0; k < 3; ++k) {
            out.direction[k] = shines[k];
            out.position[k] = to_float(m[4 * k + 3]);
            out.color[k] = std::max(0.0f, to_float(color[k] * intensity));
            brightest = std::max(brightest, out.color[k]);
        }
        names.push_back(light.text("name", tree.name(i)));
        placed.push_back(out);
    }
    // Candela and lux assume falloff with distance. Lights here have no falloff, so all of them are scaled until the brightest
    // is 1.
    if (brightest > 1) rt::log(host, RT_LOG_INFO, "light intensities are scaled by " + std::to_string(1 / brightest));
    for (size_t i = 0; i < placed.size(); ++i) {
        for (float& c : placed[i].color) c /= std::max(brightest, 1.0f);
        placed[i].name = names[i].c_str();
        rt::id(sink.light(sink.ctx, &placed[i]));
    }
}

}  // namespace gltf_import
