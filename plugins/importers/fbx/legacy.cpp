// legacy.cpp -- what files before version 7 have in other places.
#include "scene.hpp"

namespace fbx_import {
namespace {

// `Channel: "Transform" { Channel: "T" { Channel: "X" { Default: 1 } } }` of a model or of its block in a take.
const Node* axis_of(const Document& document, const Node* owner, const char* letter, const char* axis) {
    const Node* transform = document.child(owner, "Channel", "Transform");
    return document.child(document.child(transform, "Channel", letter), "Channel", axis);
}

}  // namespace

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

}  // namespace fbx_import
