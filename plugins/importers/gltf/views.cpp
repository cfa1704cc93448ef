// views.cpp -- cameras and lights. Both look along -z of their node.
#include "../common/views.hpp"

#include <algorithm>

#include "nodes.hpp"
#include "rt_plugin.hpp"
#include "tolerant.hpp"

namespace gltf_import {
namespace {

std::string label(const Value& value) {
    const std::string name = value.name();
    return name.empty() ? value.path() : in_quotes(name);
}

// The name of a camera or light, or else that of its node.
std::string name_of(const Value& value, const NodeTree& tree, size_t node) {
    const std::string name = value.name();
    return name.empty() ? tree.name(node) : name;
}

void add_camera(const Value& camera, const NodeTree& tree, size_t node, const rt_scene_sink& sink) {
    const std::string name = name_of(camera, tree, node);
    rt_camera out{};
    out.struct_bytes = sizeof out;
    out.name = name.c_str();
    out.node = tree.id(node);
    out.target[2] = -1;
    out.up[1] = 1;
    out.fov_y_rad = importers::angle_of_view(camera.object("perspective").number("yfov", 0), label(camera), sink);
    rt::id(sink.camera(sink.ctx, &out));
}

// KHR_lights_punctual: the units of `intensity` are candela and lux.
struct LightType {
    const char* name;
    rt_u32 kind;
};
constexpr LightType kLightTypes[] = {
    {"directional", RT_LIGHT_SUN},  // without an angle; lux, an irradiance
    {"point", RT_LIGHT_POINT},      // candela
    {"spot", RT_LIGHT_SPOT},        // candela, in the middle of the cone
};

void add_light(const Value& light, const NodeTree& tree, size_t node, importers::Lights& passed) {
    const std::string name = light["type"].text();
    const LightType* type = nullptr;
    for (const LightType& row : kLightTypes)
        if (name == row.name) type = &row;
    if (!type) light["type"].refuse("'directional', 'point' or 'spot'");
    rt_light_desc out = rt::light(type->kind);
    out.node = tree.id(node);
    out.direction[1] = 0;
    out.direction[2] = -1;
    const std::array<double, 3> color = light.numbers<3>("color", {1, 1, 1});
    const double intensity = light.number("intensity", 1);
    // The angles are those between the axis and the cone.
    const Value spot = light.object("spot");
    const importers::Cone cone = {2 * spot.number("outerConeAngle", 0.7853981633974483), 2 * spot.number("innerConeAngle", 0)};
    passed.add(out, name_of(light, tree, node), {color[0], color[1], color[2]}, intensity, importers::Unit::physical, cone,
               std::clamp(light.number("range", 0), 0.0, 1e15));
}

}  // namespace

void add_cameras(const Document& document, const NodeTree& tree, const rt_scene_sink& sink) {
    const Value cameras = spared_list(document, "cameras", sink);
    for (const size_t node : tree.shown()) {
        spared(sink, "the camera is left out", [&] {
            const auto index = tree.list()[node].index("camera", cameras);
            if (index) add_camera(cameras[*index], tree, node, sink);
        });
    }
}

void add_lights(const Document& document, const NodeTree& tree, const rt_host* host, const rt_scene_sink& sink) {
    constexpr const char* kExtension = "KHR_lights_punctual";
    importers::Lights passed;
    for (const size_t node : tree.shown()) {
        spared(sink, "the light is left out", [&] {
            const Value own = tree.list()[node].object("extensions").object(kExtension);
            if (!own.has("light")) return;
            const Value lights = document.root().object("extensions").object(kExtension).list("lights");
            add_light(lights[own["light"].index(lights)], tree, node, passed);
        });
    }
    passed.pass(host, sink);
}

}  // namespace gltf_import
