// views.cpp -- lights and cameras.
#include "../common/views.hpp"
#include "../common/numbers.hpp"

#include "scene.hpp"

namespace fbx_import {
namespace {

// The attributes of a model: objects that hang from it; before version 7 the model itself.
std::vector<uint32_t> attributes_of(const Context& context, uint32_t model, std::string_view type) {
    std::vector<uint32_t> out = context.objects.below(model, "NodeAttribute", type);
    if (out.empty() && context.objects[model].type == type && context.document.version() < 7000) out.push_back(model);
    return out;
}

// FBX has no units of light, but those who write files have. Intensity / 100 times the colour means:
// - of Blender, watts; of directional lights W/m^2 (export_fbx_bin.py; Blender's manual, "Light Objects"). A point of W watts
// has
//   an intensity of W / (4 pi) W/sr, for distances in metres.
// - without decay, the brightness of a white surface that faces the light (Maya's help, "Decay Rate").
// - with decay, the same at a distance of one unit: an intensity of pi times the colour. Each decay is taken for the square.
// - of an area light, the radiance of a square of 2 x 2 units of its node (Maya's help, "Area Light").
struct Meaning {
    double factor = 1;
    Unit unit = Unit::relative;
};
Meaning meaning_of(const Context& context, rt_u32 kind, int64_t decay) {
    constexpr double pi = importers::kPi;
    if (kind == RT_LIGHT_RECT || kind == RT_LIGHT_SUN) return {1, Unit::physical};
    if (context.by_blender) return {1 / (4 * pi * context.metres_per_unit * context.metres_per_unit), Unit::physical};
    return kind == RT_LIGHT_DIRECTIONAL || decay == 0 ? Meaning{} : Meaning{pi, Unit::physical};
}

// A light shines along its node's -y. LightType: 0 point, 1 directional, 2 spot, 3 area, 4 volume; Intensity in percent;
// DecayType: 0 none, 1 linear, 2 quadratic, 3 cubic; AreaLightShape: 0 rectangle, 1 sphere. Source: FBX SDK help, "FbxLight".
LightView light_of(const Context& context, const SceneNode& node, uint32_t attribute, Lights& lights) {
    const std::string& name = context.objects[node.object].name;
    const Properties p = context.properties(attribute);
    const int64_t type = p.whole("LightType", 0), decay = p.whole("DecayType", 0);
    const bool has_size = type == 3 && !context.by_blender && p.whole("AreaLightShape", 0) == 0;
    const rt_u32 kind = type == 1   ? (context.by_blender ? RT_LIGHT_SUN : RT_LIGHT_DIRECTIONAL)
                        : type == 2 ? RT_LIGHT_SPOT
                        : has_size  ? RT_LIGHT_RECT
                                    : RT_LIGHT_POINT;
    if (type > 2 && !has_size)
        context.warn(std::string("the ") + (type == 3 ? "area" : "volume") + " light '" + name +
                     "' became a point light, because the file does not say how large it is");
    const Meaning meaning = meaning_of(context, kind, decay);
    if ((decay == 1 || decay == 3) && (kind == RT_LIGHT_POINT || kind == RT_LIGHT_SPOT))
        context.warn("the light '" + name + "' has a " + (decay == 1 ? "linear" : "cubic") +
                     " decay; here its light falls by the square of the distance");
    rt_light_desc out = rt::light(kind);
    out.node = node.id;
    LightView view;
    view.color = p.vector("Color", {1, 1, 1});
    view.intensity = p.number("Intensity", 100) / 100;
    view.scale = meaning.factor;
    // OuterAngle and InnerAngle are whole angles in degrees; before version 7 `Cone angle` is the outer one.
    const double angle = p.number("OuterAngle", p.number("Cone angle", 45)), inner = p.number("InnerAngle", angle);
    lights.add(out, name, {view.color[0], view.color[1], view.color[2]}, meaning.factor * view.intensity, meaning.unit,
               {angle * kRadPerDegree, inner * kRadPerDegree});
    return view;
}

// A camera looks along its node's +x, and +y is up. Source: FBX SDK help, "FbxCamera".
rt_u32 add_camera(const Context& context, const SceneNode& node, uint32_t attribute) {
    const std::string& name = context.objects[node.object].name;
    rt_camera out{};
    out.struct_bytes = sizeof out;
    out.name = name.c_str();
    out.target[0] = out.up[1] = 1;
    const double angle = angle_of_view(context.properties(attribute));
    out.fov_y_rad = importers::angle_of_view(angle, "'" + name + "'", context.sink);
    out.node = node.id;
    return rt::id(context.sink.camera(context.sink.ctx, &out));
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

// The vertical angle of view. ApertureMode: 0 both angles are given, 1 the horizontal one, 2 the vertical one, 3 a focal length
// in mm and a film size in inches. Source: FBX SDK help, "FbxCamera". Blender writes 2 and the horizontal angle, which
// FieldOfViewX shows.
double angle_of_view(const Properties& p, std::string_view moved, double value) {
    const auto number = [&](std::string_view name, double otherwise) {
        return name == moved ? value : p.number(name, otherwise);
    };
    double width = number("AspectWidth", number("AspectW", 0)), height = number("AspectHeight", number("AspectH", 0));
    if (!(width > 0 && height > 0)) width = number("FilmWidth", 0), height = number("FilmHeight", 0);
    const double aspect = width > 0 && height > 0 ? width / height : 4.0 / 3;
    const int64_t mode = p.whole("ApertureMode", 1);
    const double film = number("FilmHeight", 0), focal = number("FocalLength", 0);
    // Blender moves the focal length also where it states an angle.
    if ((mode == 3 || moved == "FocalLength") && film > 0 && focal > 0) return 2 * std::atan(film * 25.4 / 2 / focal);
    if (mode == 0 && (p.has("FieldOfViewY") || moved == "FieldOfViewY")) return number("FieldOfViewY", 0) * kRadPerDegree;
    const double angle = number("FieldOfView", number("FieldOfViewX", number("Aperture", 40))) * kRadPerDegree;
    const bool is_vertical = mode == 2 && p.number("FieldOfView", 0) != p.number("FieldOfViewX", -1);
    return is_vertical ? angle : 2 * std::atan(std::tan(angle / 2) / aspect);
}

Views add_views(const Context& context, const std::vector<SceneNode>& nodes) {
    Views views;
    Lights lights;
    std::vector<std::pair<uint32_t, LightView>> added;
    for (const SceneNode& node : nodes) {
        for (const uint32_t attribute : attributes_of(context, node.object, "Light"))
            added.emplace_back(attribute, light_of(context, node, attribute, lights));
    }
    const std::vector<rt_u32> ids = lights.pass(context.host, context.sink);
    for (size_t i = 0; i < added.size(); ++i) {
        LightView& view = added[i].second;
        view.id = ids[i];
        view.scale *= lights.scale(i);
        views.lights[added[i].first].push_back(view);
    }
    // The view cameras of MotionBuilder, which old exporters write too ("Producer Front"), come last: the first camera is the
    // one that is shown.
    for (const bool producers : {false, true}) {
        for (const SceneNode& node : nodes) {
            if ((context.objects[node.object].name.rfind("Producer ", 0) == 0) != producers) continue;
            for (const uint32_t attribute : cameras_of(context, node.object))
                views.cameras[attribute].push_back(add_camera(context, node, attribute));
        }
    }
    return views;
}

}  // namespace fbx_import
