// clips.cpp -- animation stacks (version 7) and takes (before) with their layers and channels.
#include <algorithm>
#include <cmath>

#include "curves.hpp"

namespace fbx_import {
namespace {

// What a channel of the file moves.
struct Target {
    rt_u32 moves;
    double factor = 1;  // from the file's values to the host's
};
const std::map<std::string_view, Target> kNodeTargets = {
    {"Lcl Translation", {RT_MOVES_TRANSLATION}},
    {"Lcl Rotation", {RT_MOVES_ROTATION}},
    {"Lcl Scaling", {RT_MOVES_SCALE}},
    {"Visibility", {RT_MOVES_VISIBILITY}},
    {"T", {RT_MOVES_TRANSLATION}},
    {"R", {RT_MOVES_ROTATION}},
    {"S", {RT_MOVES_SCALE}},
};

class Clips {
 public:
    Clips(const Context& context, const std::vector<SceneNode>& nodes, const Morphs& morphs)
        : context_(context), document_(context.document), morphs_(morphs), ticks_(ticks_of_second(document_)) {
        for (uint32_t n = 0; n < nodes.size(); ++n) nodes_[nodes[n].object].push_back(nodes[n].id);
    }
    void add_stacks();
    void add_takes();

 private:
    rt_u32 add_clip(const std::string& name, double begin, double end, const std::vector<rt_layer>& layers);
    void add_curve_node(rt_u32 clip, rt_u32 layer, uint32_t object);
    void add_take_model(rt_u32 clip, const Node& model);
    void add(rt_u32 clip, rt_u32 layer, const Target& target, const std::vector<rt_u32>& ids, rt_u32 component, Curve curve);
    const std::vector<rt_u32>& nodes_of(uint32_t object) const;

    const Context& context_;
    const Document& document_;
    const Morphs& morphs_;
    const double ticks_;
    std::map<uint32_t, std::vector<rt_u32>> nodes_;
    const std::vector<rt_u32> nothing_;
};

const std::vector<rt_u32>& Clips::nodes_of(uint32_t object) const {
    const auto found = nodes_.find(object);
    return found == nodes_.end() ? nothing_ : found->second;
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

void Clips::add(rt_u32 clip, rt_u32 layer, const Target& target, const std::vector<rt_u32>& ids, rt_u32 component,
                Curve curve) {
    if (curve.times.empty()) return;
    if (target.factor != 1) curve.scale(target.factor);
    rt_channel_desc out{};
    out.struct_bytes = sizeof out;
    out.clip = clip;
    out.layer = layer;
    out.moves = target.moves;
    out.component = component;
    out.key_count = curve.times.size();
    out.times_s = curve.times.data();
    out.values = curve.values.data();
    out.spans = curve.spans.data();
    out.handles = curve.handles.empty() ? nullptr : curve.handles.data();
    out.before = curve.before;
    out.after = curve.after;
    out.before_count = curve.before_count;
    out.after_count = curve.after_count;
    for (const rt_u32 id : ids) {
        out.target = id;
        if (context_.sink.channel(context_.sink.ctx, &out) != RT_OK) throw rt::Stopped();
    }
}

// A curve node gathers the curves of one property: those of `d|X`, `d|Y`, `d|Z`, or of `d|DeformPercent` and the like. Its own
// properties are the values of components without a curve. Source: Blender developer blog; FBX SDK help, "FbxAnimCurveNode".
void Clips::add_curve_node(rt_u32 clip, rt_u32 layer, uint32_t object) {
    const Objects& objects = context_.objects;
    for (const Link* above : objects.above(object)) {
        const std::string_view property = above->property;
        const std::string_view kind = objects[above->to].kind;
        Target target{RT_MOVES_MORPH, 0.01};
        std::vector<rt_u32> ids;
        const auto of_node = kNodeTargets.find(property);
        if (kind == "Model" && of_node != kNodeTargets.end()) {
            target = of_node->second;
            ids = nodes_of(above->to);
        } else if (property == "DeformPercent") {
            const auto found = morphs_.find({above->to, ""});
            if (found != morphs_.end()) ids = found->second;
        } else if (kind == "AnimationLayer" && property == "Weight") {
            target = {RT_MOVES_LAYER, 0.01};
            ids = {layer};
        }
        if (ids.empty()) continue;
        const Properties rest(document_, objects[object].node);
        const std::vector<const Link*> curves = objects.below(object);
        const bool is_vector = target.moves <= RT_MOVES_SCALE;
        for (rt_u32 k = 0; k < (is_vector ? 3u : 1u); ++k) {
            const std::string name = is_vector ? std::string("d|") + "XYZ"[k] : "d|" + std::string(property);
            const auto curve = std::find_if(curves.begin(), curves.end(), [&](const Link* l) { return l->property == name; });
            Curve read;
            if (curve != curves.end()) read = read_curve(document_, *objects[(*curve)->from].node, ticks_);
            if (read.times.empty() && rest.has(name)) read = Curve::constant(rest.number(name, 0));
            add(clip, layer, target, ids, k, std::move(read));
        }
    }
}

// Source of the names and numbers: FBX SDK help, "FbxAnimStack" and "FbxAnimLayer". LocalStart is 0 if it is not there.
void Clips::add_stacks() {
    const Objects& objects = context_.objects;
    for (uint32_t stack = 1; stack < objects.size(); ++stack) {
        if (objects[stack].kind != "AnimationStack") continue;
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
        const Properties p = context_.properties(stack);
        const double begin = static_cast<double>(p.whole("LocalStart", 0)), end = static_cast<double>(p.whole("LocalStop", 0));
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
        const Node* time = document_.child(&take, "LocalTime");
        const double begin = document_.number(time, 0, 0), end = document_.number(time, 1, begin);
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
void Clips::add_take_model(rt_u32 clip, const Node& model) {
    const uint32_t object = context_.objects.find(document_.text(&model, 0));
    if (object == kNoObject) return;
    for (const Node& channel : document_.children(model)) {
        if (channel.name != "Channel") continue;
        const std::string_view name = document_.text(&channel, 0);
        if (name == "Transform") {
            for (const Node& part : document_.children(channel)) {
                const auto target = kNodeTargets.find(document_.text(&part, 0));
                if (part.name != "Channel" || target == kNodeTargets.end()) continue;
                for (rt_u32 k = 0; k < 3; ++k) {
                    const Node* axis = document_.child(&part, "Channel", std::string_view("XYZ").substr(k, 1));
                    if (axis) add(clip, 0, target->second, nodes_of(object), k, read_take_curve(document_, *axis, ticks_));
                }
            }
        } else if (name == "Visibility") {
            add(clip, 0, {RT_MOVES_VISIBILITY}, nodes_of(object), 0, read_take_curve(document_, channel, ticks_));
        } else if (const auto morph = morphs_.find({object, std::string(name)}); morph != morphs_.end()) {
            add(clip, 0, {RT_MOVES_MORPH, 0.01}, morph->second, 0, read_take_curve(document_, channel, ticks_));
        }
    }
}

}  // namespace

void add_clips(const Context& context, const std::vector<SceneNode>& nodes, const Morphs& morphs) {
    Clips clips(context, nodes, morphs);
    context.document.version() >= 7000 ? clips.add_stacks() : clips.add_takes();
}

}  // namespace fbx_import
