#include <algorithm>
#include <functional>

#include "scene.hpp"

namespace fbx_import {
namespace {

// Levels of nodes, at most; and how many times as many nodes as models there may be, because models whose connections mean
// others of the same name, too, are copied.
constexpr uint32_t kMaxNodeDepth = 1000;
constexpr size_t kMaxCopies = 16;

// The parent of each model: a model, the root, or kNoObject. A node has one. If the file connects it to several, the one that
// stands last in the list of objects counts, as in ufbx (synthetic_node_dag_7700_ascii); the FBX SDK's help does not say.
std::vector<uint32_t> parents_of_models(const Context& context) {
    const Objects& objects = context.objects;
    std::vector<uint32_t> out(objects.size(), kNoObject);
    std::string first;
    size_t count = 0;
    for (const uint32_t model : objects.of_kind("Model")) {
        uint32_t& parent = out[model];
        bool has_several = false;
        for (const Link* link : objects.above(model)) {
            const bool is_parent = link->to == kRoot || objects[link->to].kind == "Model";
            if (!is_parent || !link->property.empty() || !link->from_property.empty()) continue;
            has_several = has_several || (parent != kNoObject && parent != link->to);
            parent = parent == kNoObject ? link->to : std::max(parent, link->to);
        }
        if (!has_several || objects[model].has_namesakes) continue;
        const std::string name = parent == kRoot ? "the root" : "'" + objects[parent].name + "'";
        if (count++ == 0) first = "the node '" + objects[model].name + "' hangs from several nodes; it is shown below " + name;
    }
    if (count > 0) context.warn(first + " only" + (count > 1 ? ", and so are " + std::to_string(count - 1) + " others" : ""));
    return out;
}

// `Channel: "Transform" { Channel: "T" { Channel: "X" { Default: 1 } } }` of a model or of its block in a take.
const Node* axis_of(const Document& document, const Node* owner, const char* letter, std::string_view axis) {
    const Node* transform = document.child(owner, "Channel", "Transform");
    return document.child(document.child(transform, "Channel", letter), "Channel", axis);
}

// Up to version 5.8, the values at rest are the defaults of the channels, of the model itself (measured from
// max7_skin_5000_binary) or of the current take (measured from max2009_cube_anim_5800_ascii).
Vec3 oldest_rest(const Document& document, const Object& model, const char* letter, Vec3 out) {
    const Node* in_take = in_current_take(document, *model.node);
    for (size_t k = 0; k < 3; ++k) {
        const std::string_view axis = std::string_view("XYZ").substr(k, 1);
        const Node* found = axis_of(document, model.node, letter, axis);
        if (!found) found = axis_of(document, in_take, letter, axis);
        out[k] = document.number(document.child(found, "Default"), 0, out[k]);
    }
    return out;
}

// A node's own transform is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1. Source: FBX SDK help, "Computing transformation
// matrices". Pre- and post-rotation always turn in the order xyz, and like the rotation order they count only if RotationActive
// is set. Geometric transforms turn in the order xyz. Source: FBX SDK help, "FbxNode"; measured from
// casegen_rotation_space_7500_ascii and max_geometry_transform_7700_ascii.
void read_transform(const Context& context, const Object& model, const Properties& p, rt_node_desc& out) {
    const Vec3 zero{}, one{1, 1, 1};
    const auto copy = [](const auto& from, double* to) { std::copy(from.begin(), from.end(), to); };
    const auto rest = [&](const char* letter, const char* name, const Vec3& otherwise) {
        const Vec3 found = p.vector(name, otherwise);
        return context.document.version() < 6000 ? oldest_rest(context.document, model, letter, found) : found;
    };
    copy(rest("T", "Lcl Translation", zero), out.translation);
    copy(rest("R", "Lcl Rotation", zero), out.rotation);
    copy(rest("S", "Lcl Scaling", one), out.scale);
    const bool active = p.whole("RotationActive", 0) != 0;
    const int64_t order = active ? p.whole("RotationOrder", 0) : 0;
    out.rotation_order = order >= 0 && order <= 5 ? static_cast<rt_u32>(order) : rt_u32(RT_ROTATE_XYZ);  // 6: spheric xyz
    // 0 RrSs, 1 RSrs, 2 Rrs. Source: FBX SDK help, "FbxTransform::EInheritType".
    const int64_t inherit = p.whole("InheritType", 1);
    out.inherit = inherit == 0 ? RT_INHERIT_RRSS : inherit == 2 ? RT_INHERIT_RRS : RT_INHERIT_RSRS;
    const auto moved = [&](const char* name, double by = 1) {
        const Vec3 v = p.vector(name, zero);
        return translation({by * v[0], by * v[1], by * v[2]});
    };
    const Transform to_pivot = multiply(moved("RotationOffset"), moved("RotationPivot"));
    const Transform to_scale_pivot = multiply(moved("ScalingOffset"), moved("ScalingPivot"));
    const Transform before = active ? rotation(p.vector("PreRotation", zero)) : kIdentity;
    const Transform after = active ? transposed(rotation(p.vector("PostRotation", zero))) : kIdentity;
    copy(multiply(to_pivot, before), out.before_rotation);
    copy(multiply(after, multiply(moved("RotationPivot", -1), to_scale_pivot)), out.after_rotation);
    copy(moved("ScalingPivot", -1), out.after_scale);
}

Transform geometric_transform(const Properties& p) {
    const Vec3 zero{}, one{1, 1, 1};
    return multiply(translation(p.vector("GeometricTranslation", zero)),
                    multiply(rotation(p.vector("GeometricRotation", zero)), scaling(p.vector("GeometricScaling", one))));
}

SceneNode pass(const Context& context, uint32_t model, uint32_t parent, const std::vector<SceneNode>& nodes) {
    const Object& object = context.objects[model];
    const Properties p = context.properties(model);
    rt_node_desc out{};
    out.struct_bytes = sizeof out;
    out.parent = parent == kNoObject ? 0 : nodes[parent].id;
    out.name = object.name.c_str();
    read_transform(context, object, p, out);
    if (p.number("Visibility", 1) < 0.5) out.flags |= RT_NODE_HIDDEN;
    if (p.number("Visibility Inheritance", 1) == 0) out.flags |= RT_NODE_OWN_VISIBILITY;
    return {model, rt::id(context.sink.node(context.sink.ctx, &out)), geometric_transform(p)};
}

}  // namespace

std::vector<SceneNode> read_nodes(const Context& context) {
    const Objects& objects = context.objects;
    const std::vector<uint32_t> models = objects.of_kind("Model");
    const std::vector<uint32_t> parents = parents_of_models(context);
    std::vector<bool> is_open(objects.size()), is_done(objects.size());
    std::vector<SceneNode> nodes;
    const auto fail = [&](uint32_t model, const std::string& what) {
        context.document.fail(*objects[model].node, "the node '" + objects[model].name + "' " + what);
    };
    std::function<void(uint32_t, uint32_t, uint32_t)> add_below;
    const std::function<void(uint32_t, uint32_t, uint32_t)> add = [&](uint32_t model, uint32_t parent, uint32_t depth) {
        if (is_open[model]) fail(model, "hangs from itself: the nodes form a circle; expected a tree");
        if (depth > kMaxNodeDepth) fail(model, "has more than 1000 nodes above it; expected at most that");
        if (nodes.size() > kMaxCopies * models.size())
            fail(model, "hangs from several nodes that do the same: too many copies of it");
        is_open[model] = is_done[model] = true;
        nodes.push_back(pass(context, model, parent, nodes));
        const uint32_t index = static_cast<uint32_t>(nodes.size() - 1);
        add_below(model, index, depth + 1);
        is_open[model] = false;
    };
    add_below = [&](uint32_t above, uint32_t parent, uint32_t depth) {
        for (const uint32_t child : objects.below(above, "Model")) {
            // Where names are ids, each connection may mean another model of the same name (see Objects::add).
            const bool is_own = parents[child] == above && !is_done[child];
            if (is_own || objects[child].has_namesakes) add(child, parent, depth);
        }
    };
    add_below(kRoot, kNoObject, 0);
    // Models without a parent are shown too: MotionBuilder's own cameras have none (motionbuilder_cube_7700_binary).
    for (const uint32_t model : models) {
        if (parents[model] == kNoObject) add(model, kNoObject, 0);
    }
    for (const uint32_t model : models) {
        if (!is_done[model]) fail(model, "hangs from itself: the nodes form a circle; expected a tree");
    }
    return nodes;
}

}  // namespace fbx_import
