// views.cpp -- cameras and lights. Both look along -z of their node.
#include "../common/views.hpp"

#include "nodes.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

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
        const std::string name = camera.text("name", tree.name(i));
        rt_camera out{};
        out.struct_bytes = sizeof out;
        out.name = name.c_str();
        out.node = tree.id(i);
        out.target[2] = -1;
        out.up[1] = 1;
        out.fov_y_rad = importers::angle_of_view(camera.object("perspective").number("yfov", 0), label(camera), sink);
        rt::id(sink.camera(sink.ctx, &out));
    }
}

void add_lights(const Document& document, const NodeTree& tree, const rt_host* host, const rt_scene_sink& sink) {
    constexpr const char* kExtension = "KHR_lights_punctual";
    const Value lights = document.root().object("extensions").object(kExtension).list("lights");
    importers::Lights passed;
    for (const size_t i : tree.shown()) {
        const auto index = tree.list()[i].object("extensions").object(kExtension).index("light", lights);
        if (!index) continue;
        const Value light = lights[*index];
        const std::string type = light["type"].text();
        if (type != "directional" && type != "point" && type != "spot")
            light["type"].refuse("'directional', 'point' or 'spot'");
        if (type == "spot") rt::warn(sink, "the spot light " + label(light) + " became a point light");
        rt_light_desc out = rt::light(type == "directional" ? RT_LIGHT_DIRECTIONAL : RT_LIGHT_POINT, nullptr);
        out.node = tree.id(i);
        out.direction[1] = 0;
        out.direction[2] = -1;
        const std::array<double, 3> color = light.numbers<3>("color", {1, 1, 1});
        passed.add(out, light.text("name", tree.name(i)), {color[0], color[1], color[2]}, light.number("intensity", 1));
    }
    passed.pass(host, sink);
}

}  // namespace gltf_import
