// clips.cpp -- animation stacks (version 7) and takes (before) with their layers and channels.
#include <algorithm>
#include <functional>
#include <set>

#include "curves.hpp"

namespace fbx_import {
namespace {

// What the values of a property move.
struct Output {
    rt_u32 moves, target, component = 0;  // as rt_channel_desc has them
    rt_u32 curve = 0;                     // number of the property's curve: those of vectors are x, y and z
    std::function<double(double)> value;  // from the file's values to the host's; none: they are the same
};
const std::map<std::string_view, rt_u32> kNodeProperties = {
    {"Lcl Translation", RT_MOVES_TRANSLATION}, {"T", RT_MOVES_TRANSLATION},
    {"Lcl Rotation", RT_MOVES_ROTATION},       {"R", RT_MOVES_ROTATION},
    {"Lcl Scaling", RT_MOVES_SCALE},           {"S", RT_MOVES_SCALE},
    {"Visibility", RT_MOVES_VISIBILITY},       {"Color", RT_MOVES_COLOR},
};
bool is_vector(std::string_view property) {
    const auto found = kNodeProperties.find(property);
    return found != kNodeProperties.end() && found->second != RT_MOVES_VISIBILITY;
}
const std::set<std::string_view> kAngles = {"FieldOfView", "FieldOfViewX", "FieldOfViewY", "FocalLength", "Aperture"};

class Clips {
 public:
    Clips(const Context& context, const std::vector<SceneNode>& nodes, const Views& views, const Morphs& morphs)
        : context_(context), document_(context.document), views_(views), morphs_(morphs), ticks_(ticks_of_second(document_)) {
        for (const SceneNode& node : nodes) nodes_[node.object].push_back(node.id);
    }
    void add_stacks();
    void add_takes();
    void report() const;  // warns about what was left out

 private:
    std::pair<double, double> range_of_take(const Node* take) const;
    std::pair<double, double> range_of_stack(uint32_t stack) const;
    rt_u32 add_clip(const std::string& name, double begin, double end, const std::vector<rt_layer>& layers);
    std::vector<Output> outputs_of(rt_u32 clip, uint32_t object, std::string_view property);
    void add_curve_node(rt_u32 clip, rt_u32 layer, uint32_t object);
    void add_take_model(rt_u32 clip, const Node& model) {
        add_channels(clip, context_.objects.find(document_.text(&model, 0)), model);
    }
    void add_channels(rt_u32 clip, uint32_t object, const Node& parent);
    void add(rt_u32 clip, rt_u32 layer, const Output& output, Curve curve);
    template <class Read>
    Curve curve(const Read& read, const Node& node);

    const Context& context_;
    const Document& document_;
    const Views& views_;
    const Morphs& morphs_;
    const double ticks_;
    std::map<uint32_t, std::vector<rt_u32>> nodes_;                             // of the host, by object
    std::map<std::pair<rt_u32, uint32_t>, std::string_view> light_properties_;  // that move, by clip and object
    std::map<const Node*, std::string> broken_;                                 // curves, and why
};

template <class Map>
typename Map::mapped_type found_in(const Map& map, const typename Map::key_type& key) {
    const auto found = map.find(key);
    return found == map.end() ? typename Map::mapped_type() : found->second;
}

// What a property of an object moves; nothing, if the host has no such thing.
std::vector<Output> Clips::outputs_of(rt_u32 clip, uint32_t object, std::string_view property) {
    std::vector<Output> out;
    const bool is_color = property == "Color";
    if (const auto known = kNodeProperties.find(property); known != kNodeProperties.end() && !is_color) {
        for (const rt_u32 id : found_in(nodes_, object)) {
            for (rt_u32 k = 0; k < (is_vector(property) ? 3 : 1); ++k) out.push_back({known->second, id, k, k, {}});
        }
    }
    // A channel of a shape has its percentage; before version 7 the shape's name is that of the property.
    const std::string_view suffix = document_.version() < 6000 ? kShapeSuffix : "";
    const bool is_oldest = property.size() > suffix.size() && property.substr(property.size() - suffix.size()) == suffix;
    const std::string_view shape = is_oldest ? property.substr(0, property.size() - suffix.size()) : property;
    for (const rt_u32 id : found_in(morphs_, {object, property == "DeformPercent" ? "" : std::string(shape)}))
        out.push_back({RT_MOVES_MORPH, id, 0, 0, [](double percent) { return percent / 100; }});
    for (const LightView& light : found_in(views_.lights, is_color || property == "Intensity" ? object : kNoObject)) {
        const std::string_view other = light_properties_.emplace(std::make_pair(clip, object), property).first->second;
        if (other != property) {
            context_.warn("the colour and the intensity of a light both move; only its " + std::string(other) + " does here");
            break;
        }
        for (rt_u32 k = 0; k < 3; ++k) {
            const double factor = light.scale * (is_color ? light.intensity : light.color[k] / 100);
            out.push_back({RT_MOVES_COLOR, light.id, k, is_color ? k : 0, [=](double x) { return x * factor; }});
        }
    }
    for (const rt_u32 id : found_in(views_.cameras, kAngles.count(property) ? object : kNoObject)) {
        const Properties camera = context_.properties(object);
        out.push_back({RT_MOVES_FOV, id, 0, 0, [=](double x) { return angle_of_view(camera, property, x); }});
    }
    return out;
}

rt_u32 Clips::add_clip(const std::string& name, double begin, double end, const std::vector<rt_layer>& layers) {
    rt_clip_desc out{};
    out.struct_bytes = sizeof out;
    out.name = name.c_str();
    out.begin_s = begin / ticks_;
    out.end_s = std::max(end, begin) / ticks_;
    out.fps = context_.fps;
    out.layers = layers.data();
    out.layer_count = static_cast<rt_u32>(layers.size());
    return rt::id(context_.sink.clip(context_.sink.ctx, &out));
}

void Clips::add(rt_u32 clip, rt_u32 layer, const Output& output, Curve curve) {
    if (curve.times.empty()) return;
    if (output.value) curve.convert(output.value);
    curve.pass(importers::channel(clip, layer, output.moves, output.target, output.component), context_.sink);
}

// The curve of a node, or none if it is broken: it costs itself alone.
template <class Read>
Curve Clips::curve(const Read& read, const Node& node) {
    try {
        return read(document_, node, ticks_);
    } catch (const Broken& why) {
        broken_.emplace(&node, why.what());
        return {};
    }
}

void Clips::report() const {
    if (broken_.empty()) return;
    const std::string many =
        broken_.size() == 1 ? "a curve of an animation is" : std::to_string(broken_.size()) + " curves of animations are";
    context_.warn(many + " left out: " + broken_.begin()->second);
}

// A curve node gathers the curves of one property: those of `d|X`, `d|Y`, `d|Z`, or of `d|DeformPercent` and the like. Its own
// properties are the values of components without a curve. Source: Blender developer blog; FBX SDK help, "FbxAnimCurveNode".
void Clips::add_curve_node(rt_u32 clip, rt_u32 layer, uint32_t object) {
    const Objects& objects = context_.objects;
    const Properties rest(document_, objects[object].node);
    const std::vector<const Link*>& curves = objects.below(object);
    for (const Link* above : objects.above(object)) {
        const std::string_view property = above->property;
        std::vector<Output> outputs = outputs_of(clip, above->to, property);
        if (property == "Weight" && objects[above->to].kind == "AnimationLayer")
            outputs.push_back({RT_MOVES_LAYER, layer, 0, 0, [](double percent) { return percent / 100; }});
        for (rt_u32 k = 0; k < 3 && !outputs.empty(); ++k) {
            const std::string name = "d|" + (is_vector(property) ? std::string(1, "XYZ"[k]) : std::string(property));
            const auto found = std::find_if(curves.begin(), curves.end(), [&](const Link* l) { return l->property == name; });
            Curve read;
            if (found != curves.end()) read = curve(read_curve, *objects[(*found)->from].node);
            if (read.times.empty() && rest.has(name)) read = Curve::constant(rest.number(name, 0));
            for (const Output& output : outputs) {
                if (output.curve == k) add(clip, layer, output, read);
            }
            if (!is_vector(property)) break;
        }
    }
}

// In ticks: `Take: "name" { LocalTime: begin, end  ReferenceTime: begin, end }`.
std::pair<double, double> Clips::range_of_take(const Node* take) const {
    const Node* time = document_.child(take, "LocalTime");
    if (!time) time = document_.child(take, "ReferenceTime");
    const double begin = document_.number(time, 0, 0);
    return {begin, document_.number(time, 1, begin)};
}

// Likewise. ZBrush writes stacks without properties of their own; the take of the same name has the range then (measured from
// zbrush_polygroup_mess_7500_binary, whose template says 0).
std::pair<double, double> Clips::range_of_stack(uint32_t stack) const {
    const Properties p(document_, context_.objects[stack].node);
    for (const std::string kind : {"Local", "Reference"}) {
        if (!p.has(kind + "Start") && !p.has(kind + "Stop")) continue;
        return {static_cast<double>(p.whole(kind + "Start", 0)), static_cast<double>(p.whole(kind + "Stop", 0))};
    }
    const Node* takes = document_.child(&document_.root(), "Takes");
    if (!takes) return {0, 0};
    for (const Node& take : document_.children(*takes)) {
        if (take.name == "Take" && plain_name(document_, document_.text(&take, 0)) == context_.objects[stack].name)
            return range_of_take(&take);
    }
    return {0, 0};
}

// Source of the names and numbers: FBX SDK help, "FbxAnimStack" and "FbxAnimLayer". A start that is not there is 0.
void Clips::add_stacks() {
    const Objects& objects = context_.objects;
    for (const uint32_t stack : objects.of_kind("AnimationStack")) {
        std::vector<rt_layer> layers;
        std::vector<uint32_t> layer_objects;
        for (const uint32_t layer : objects.below(stack, "AnimationLayer")) {
            const Properties p = context_.properties(layer);
            if (p.whole("Mute", 0) != 0) continue;
            const int64_t mode = p.whole("BlendMode", 0);  // 0 additive, 1 override, 2 override passthrough
            rt_layer out{};
            out.mode = mode == 1 ? RT_LAYER_REPLACES : mode == 2 ? RT_LAYER_BLENDS : RT_LAYER_ADDS;
            if (p.whole("RotationAccumulationMode", 0) == 1) out.flags |= RT_LAYER_ROTATES_BY_CHANNEL;
            if (p.whole("ScaleAccumulationMode", 0) == 1) out.flags |= RT_LAYER_ADDS_SCALES;
            out.weight = std::clamp(p.number("Weight", 100) / 100, 0.0, 1.0);
            layers.push_back(out);
            layer_objects.push_back(layer);
        }
        const auto [begin, end] = range_of_stack(stack);
        const rt_u32 clip = add_clip(objects[stack].name, begin, end, layers);
        for (rt_u32 l = 0; l < layers.size(); ++l) {
            for (const uint32_t node : objects.below(layer_objects[l], "AnimationCurveNode")) add_curve_node(clip, l, node);
        }
    }
}

// `Take: "name" { LocalTime: begin, end  Model: "Model::Cube" { Channel: ... } }`.
void Clips::add_takes() {
    const Node* takes = document_.child(&document_.root(), "Takes");
    if (!takes) return;
    for (const Node& take : document_.children(*takes)) {
        if (take.name != "Take") continue;
        const auto [begin, end] = range_of_take(&take);
        const rt_u32 clip = add_clip(plain_name(document_, document_.text(&take, 0)), begin, end, {});
        for (const Node& model : document_.children(take)) {
            if (model.name == "Model") add_take_model(clip, model);
        }
    }
    // Channels that stand in the models themselves, outside of takes, are a clip of their own, which comes last (measured from
    // max7_skin_5000_binary and its record).
    rt_u32 clip = 0;
    for (const Node& model : document_.children(document_.root())) {
        if (model.name != "Model" || !document_.child(&model, "Channel")) continue;
        if (clip == 0) clip = add_clip("(internal)", 0, 0, {});
        add_take_model(clip, model);
    }
}

// The channels "T", "R" and "S" are in the channel "Transform", each with channels "X", "Y" and "Z"; "Visibility" and those of
// shapes stand beside it. Measured from maya_game_sausage_6100_ascii_combined and maya_blend_shape_cube_6100_binary.
void Clips::add_channels(rt_u32 clip, uint32_t object, const Node& parent) {
    for (const Node& channel : document_.children(parent)) {
        const std::string_view name = document_.text(&channel, 0);
        if (channel.name != "Channel") continue;
        if (name == "Transform") add_channels(clip, object, channel);
        for (const Output& output : outputs_of(clip, object, name)) {
            const std::string_view axis = std::string_view("XYZ").substr(output.curve, 1);
            const Node* node = is_vector(name) ? document_.child(&channel, "Channel", axis) : &channel;
            if (node) add(clip, 0, output, curve(read_take_curve, *node));
        }
    }
}

}  // namespace

const Node* in_current_take(const Document& document, const Node& model) {
    const Node* takes = document.child(&document.root(), "Takes");
    const Node* take = document.child(takes, "Take", document.text(takes, "Current"));
    if (!take) take = document.child(takes, "Take");
    return document.child(take, "Model", document.text(&model, 0));
}

void add_clips(const Context& context, const std::vector<SceneNode>& nodes, const Views& views, const Morphs& morphs) {
    Clips clips(context, nodes, views, morphs);
    context.document.version() >= 7000 ? clips.add_stacks() : clips.add_takes();
    clips.report();
}

}  // namespace fbx_import
