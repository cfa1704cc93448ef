// views.cpp -- lights and cameras.
#include <algorithm>
#include <cmath>

#include "scene.hpp"

namespace fbx_import {
namespace {

// The attributes of a model: objects that hang from it; before version 7 the model itself.
std::vector<uint32_t> attributes_of(const Context& context, uint32_t model, std::string_view type) {
    std::vector<uint32_t> out = context.objects.below(model, "NodeAttribute", type);
    if (out.empty() && context.objects[model].type == type && context.document.version() < 7000) out.push_back(model);
    return out;
}

// A light shines along its node's -y. LightType: 0 point, 1 directional, 2 spot, 3 area, 4 volume; Intensity in percent.
// Source: FBX SDK help, "FbxLight".
rt_light_desc light_of(const Context& context, const SceneNode& node, uint32_t attribute) {
    const std::string& name = context.objects[node.object].name;
    const Properties p = context.properties(attribute);
    const int64_t type = p.whole("LightType", 0);
    rt_light_desc out = rt::light(type == 1 ? RT_LIGHT_DIRECTIONAL : RT_LIGHT_POINT, name.c_str());
    out.direction[1] = -1;
    if (type > 1)
        context.warn(std::string("the ") + (type == 2 ? "spot" : "area") + " light '" + name + "' became a point light");
    const Vec3 color = p.vector("Color", {1, 1, 1});
    const double intensity = p.number("Intensity", 100) / 100;
    for (int k = 0; k < 3; ++k) {
        const double c = color[k] * intensity;
        out.color[k] = std::isfinite(c) ? static_cast<float>(std::clamp(c, 0.0, 1e30)) : 0;
    }
    out.node = node.id;
    return out;
}

// The vertical angle of view. ApertureMode: 0 both angles are given, 1 the horizontal one, 2 the vertical one, 3 a focal length
// in mm and a film size in inches. Source: FBX SDK help, "FbxCamera". Blender writes 2 and the horizontal angle, which
// FieldOfViewX shows.
double angle_of(const Properties& p) {
    constexpr double radians = 0.017453292519943295;
    double width = p.number("AspectWidth", p.number("AspectW", 0)), height = p.number("AspectHeight", p.number("AspectH", 0));
    if (!(width > 0 && height > 0)) width = p.number("FilmWidth", 0), height = p.number("FilmHeight", 0);
    const double aspect = width > 0 && height > 0 ? width / height : 4.0 / 3;
    const int64_t mode = p.whole("ApertureMode", 1);
    const double film = p.number("FilmHeight", 0), focal = p.number("FocalLength", 0);
    if (mode == 3 && film > 0 && focal > 0) return 2 * std::atan(film * 25.4 / 2 / focal);
    if (mode == 0 && p.has("FieldOfViewY")) return p.number("FieldOfViewY", 0) * radians;
    const double angle = p.number("FieldOfView", p.number("FieldOfViewX", p.number("Aperture", 40))) * radians;
    const bool is_vertical = mode == 2 && p.number("FieldOfView", 0) != p.number("FieldOfViewX", -1);
    return is_vertical ? angle : 2 * std::atan(std::tan(angle / 2) / aspect);
}

// A camera looks along its node's +x, and +y is up. Source: FBX SDK help, "FbxCamera".
rt_camera camera_of(const Context& context, const SceneNode& node, uint32_t attribute) {
    const std::string& name = context.objects[node.object].name;
    rt_camera out{};
    out.struct_bytes = sizeof out;
    out.name = name.c_str();
    out.target[0] = out.up[1] = 1;
    double angle = angle_of(context.properties(attribute));
    if (!(angle > 0.001) || angle > 3.1) {
        context.warn("the camera '" + name + "' has no angle of view (orthographic?): 45 degrees are used");
        angle = 0.7853982;
    }
    out.fov_y_rad = static_cast<float>(angle);
    out.node = node.id;
    return out;
}

// A stereo camera consists of two, which hang from its attribute (measured from maya_node_attribute_zoo_7500_binary and
// _6100_).
std::vector<uint32_t> cameras_of(const Context& context, uint32_t model) {
    std::vector<uint32_t> out = attributes_of(context, model, "Camera");
    for (const uint32_t stereo : attributes_of(context, model, "CameraStereo")) {
        for (const Link* link : context.objects.below(stereo)) {
            if (link->property == "LeftCamera" || link->property == "RightCamera") out.push_back(link->from);
        }
    }
    return out;
}

}  // namespace

void add_views(const Context& context, const std::vector<SceneNode>& nodes) {
    std::vector<rt_light_desc> lights;
    float brightest = 0;
    for (const SceneNode& node : nodes) {
        for (const uint32_t attribute : attributes_of(context, node.object, "Light")) {
            lights.push_back(light_of(context, node, attribute));
            brightest = std::max(brightest, *std::max_element(lights.back().color, lights.back().color + 3));
        }
    }
    // Physical intensities (watts, candela) assume falloff with distance. Lights here have none, so all of them are scaled
    // until the brightest is 1.
    if (brightest > 1) rt::log(context.host, RT_LOG_INFO, "light intensities are scaled by " + std::to_string(1 / brightest));
    for (rt_light_desc& light : lights) {
        for (float& c : light.color) c = brightest > 1 ? c / brightest : c;
        rt::id(context.sink.light(context.sink.ctx, &light));
    }
    // The view cameras of MotionBuilder, which old exporters write too ("Producer Front"), come last: the first camera is the
    // one that is shown.
    for (const bool producers : {false, true}) {
        for (const SceneNode& node : nodes) {
            if ((context.objects[node.object].name.rfind("Producer ", 0) == 0) != producers) continue;
            for (const uint32_t attribute : cameras_of(context, node.object)) {
                const rt_camera camera = camera_of(context, node, attribute);
                rt::id(context.sink.camera(context.sink.ctx, &camera));
            }
        }
    }
}

}  // namespace fbx_import
