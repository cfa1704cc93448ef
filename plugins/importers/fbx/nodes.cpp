#include <algorithm>

#include "scene.hpp"

namespace fbx_import {
namespace {

// Levels of nodes, at most; and how many times as many nodes as models there may be, because models with several parents are
// copied.
constexpr uint32_t kMaxNodeDepth = 1000;
constexpr size_t kMaxCopies = 16;

// Models without a parent are shown too: MotionBuilder's own cameras have none (motionbuilder_cube_7700_binary).
std::vector<uint32_t> top_models(const Context& context) {
    const Objects& objects = context.objects;
    std::vector<uint32_t> out = objects.below(kRoot, "Model");
    std::vector<bool> is_top(objects.size());
    for (const uint32_t model : out) is_top[model] = true;
    for (uint32_t i = 1; i < objects.size(); ++i) {
        if (objects[i].kind != "Model" || is_top[i]) continue;
        const std::vector<const Link*> above = objects.above(i);
        const auto is_parent = [&](const Link* link) { return link->property.empty() && objects[link->to].kind == "Model"; };
        if (std::none_of(above.begin(), above.end(), is_parent)) out.push_back(i);
    }
    return out;
}

// `Channel: "Transform" { Channel: "T" { Channel: "X" { Default: 1 } } }` of a model or of its block in a take.
const Node* axis_of(const Document& document, const Node* owner, const char* letter, const char* axis) {
    const Node* transform = document.child(owner, "Channel", "Transform");
    return document.child(document.child(transform, "Channel", letter), "Channel", axis);
}

// Up to version 5.8, the values at rest are the defaults of the channels, of the model itself (measured from
// max7_skin_5000_binary) or of the current take (measured from max2009_cube_anim_5800_ascii).
double oldest_rest(const Document& document, const Object& model, const char* letter, const char* axis, double otherwise) {
    if (document.version() >= 6000) return otherwise;
    const Node* found = axis_of(document, model.node, letter, axis);
    if (!found) {
        const Node* takes = document.child(&document.root(), "Takes");
        const Node* take = document.child(takes, "Take", document.text(document.child(takes, "Current"), 0));
        if (!take) take = document.child(takes, "Take");
        found = axis_of(document, document.child(take, "Model", document.text(model.node, 0)), letter, axis);
    }
    return document.number(document.child(found, "Default"), 0, otherwise);
}

NodeTransform transform_of(const Context& context, uint32_t model) {
    NodeTransform out = node_transform(context.properties(model));
    const Object& object = context.objects[model];
    for (int k = 0; k < 3; ++k) {
        const char* axis = k == 0 ? "X" : k == 1 ? "Y" : "Z";
        out.translation[k] = oldest_rest(context.document, object, "T", axis, out.translation[k]);
        out.rotation[k] = oldest_rest(context.document, object, "R", axis, out.rotation[k]);
        out.scale[k] = oldest_rest(context.document, object, "S", axis, out.scale[k]);
    }
    return out;
}

rt_u32 pass(const Context& context, const SceneNode& node, const std::vector<SceneNode>& nodes) {
    const NodeTransform& t = node.transform;
    rt_node_desc out{};
    out.struct_bytes = sizeof out;
    out.parent = node.parent == kNoObject ? 0 : nodes[node.parent].id;
    out.name = context.objects[node.object].name.c_str();
    out.rotation_order = t.rotation_order;
    out.inherit = t.inherit;
    std::copy(t.translation.begin(), t.translation.end(), out.translation);
    std::copy(t.rotation.begin(), t.rotation.end(), out.rotation);
    std::copy(t.scale.begin(), t.scale.end(), out.scale);
    std::copy(t.before_rotation.begin(), t.before_rotation.end(), out.before_rotation);
    std::copy(t.after_rotation.begin(), t.after_rotation.end(), out.after_rotation);
    std::copy(t.after_scale.begin(), t.after_scale.end(), out.after_scale);
    const Properties p = context.properties(node.object);
    if (p.number("Visibility", 1) < 0.5) out.flags |= RT_NODE_HIDDEN;
    if (p.number("Visibility Inheritance", 1) == 0) out.flags |= RT_NODE_OWN_VISIBILITY;
    return rt::id(context.sink.node(context.sink.ctx, &out));
}

}  // namespace

std::vector<SceneNode> read_nodes(const Context& context) {
    const Objects& objects = context.objects;
    struct Pending {
        uint32_t model, parent, depth;
        bool leave;  // everything below the model is done
    };
    std::vector<Pending> stack;
    const std::vector<uint32_t> top = top_models(context);
    for (auto at = top.rbegin(); at != top.rend(); ++at) stack.push_back({*at, kNoObject, 0, false});
    size_t models = 0;
    for (uint32_t i = 1; i < objects.size(); ++i) models += objects[i].kind == "Model";
    std::vector<bool> is_open(objects.size()), is_done(objects.size());
    std::vector<SceneNode> nodes;
    const auto fail = [&](uint32_t model, const std::string& what) {
        throw Broken(context.document.place(*objects[model].node) + ": the node '" + objects[model].name + "' " + what);
    };
    while (!stack.empty()) {
        const Pending at = stack.back();
        stack.pop_back();
        if (at.leave) {
            is_open[at.model] = false;
            continue;
        }
        if (is_open[at.model]) fail(at.model, "hangs from itself: the nodes form a circle; expected a tree");
        if (at.depth > kMaxNodeDepth) fail(at.model, "has more than 1000 nodes above it; expected at most that");
        if (nodes.size() > kMaxCopies * models)
            fail(at.model, "hangs from several nodes that do the same: too many copies of it");
        is_open[at.model] = is_done[at.model] = true;
        stack.push_back({at.model, 0, 0, true});
        SceneNode node;
        node.object = at.model;
        node.parent = at.parent;
        node.transform = transform_of(context, at.model);
        node.id = pass(context, node, nodes);
        nodes.push_back(node);
        const uint32_t index = static_cast<uint32_t>(nodes.size() - 1);
        const std::vector<const Link*> below = objects.below(at.model);
        for (auto link = below.rbegin(); link != below.rend(); ++link) {
            if (objects[(*link)->from].kind == "Model" && (*link)->property.empty() && (*link)->from_property.empty()) {
                stack.push_back({(*link)->from, index, at.depth + 1, false});
            }
        }
    }
    for (uint32_t i = 1; i < objects.size(); ++i) {
        if (objects[i].kind == "Model" && !is_done[i]) fail(i, "hangs from itself: the nodes form a circle; expected a tree");
    }
    return nodes;
}

}  // namespace fbx_import
