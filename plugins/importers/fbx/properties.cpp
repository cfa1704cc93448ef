#include "properties.hpp"

namespace fbx_import {

// Version 7: `Properties70`, each `P: "name", "type", "label", "flags", values`. Version 6: `Properties60`, each
// `Property: "name", "type", "flags", values`. Before: children of the object by their names. Source: Blender developer blog;
// measured from max_quote_6100_ascii and max2009_blob_5800_ascii. Of two of a name, the last one counts, as in ufbx
// (synthetic_duplicate_prop_7500_ascii).
Properties::Properties(const Document& document, const Node* object, const Node* defaults)
    : document_(document), object_(object) {
    add(defaults);
    add(object);
}

void Properties::add(const Node* owner) {
    for (const char* name : {"Properties70", "Properties60"}) {
        const Node* list = document_.child(owner, name);
        if (!list) continue;
        for (const Node& node : document_.children(*list)) {
            const bool is_new = node.name == "P";
            if (is_new || node.name == "Property") places_[document_.text(&node, 0)] = {&node, is_new ? 4u : 3u};
        }
    }
}

Properties::Place Properties::find(std::string_view name) const {
    const auto found = places_.find(name);
    return found != places_.end() ? found->second : Place{document_.child(object_, name), 0};
}

Vec3 Properties::vector(std::string_view name, const Vec3& otherwise) const {
    const auto [node, first] = find(name);
    Vec3 out;
    for (size_t k = 0; k < 3; ++k) out[k] = document_.number(node, first + k, otherwise[k]);
    return out;
}

// `Definitions: ObjectType: "Model" { PropertyTemplate: "FbxNode" { Properties70 } }`. Node attributes have one for each type:
// "FbxLight", "FbxCamera". Source: Blender developer blog; measured from motionbuilder_lights_7700_ascii.
Templates::Templates(const Document& document) : document_(document) {
    const Node* definitions = document.child(&document.root(), "Definitions");
    if (!definitions) return;
    for (const Node& type : document.children(*definitions)) {
        if (type.name != "ObjectType") continue;
        const bool has_several = document.text(&type, 0) == "NodeAttribute";
        for (const Node& found : document.children(type)) {
            if (found.name == "PropertyTemplate") all_.emplace(document.text(has_several ? &found : &type, 0), &found);
        }
    }
}

Properties Templates::of(const Object& object) const {
    const auto found = all_.find(object.kind == "NodeAttribute" ? "Fbx" + std::string(object.type) : std::string(object.kind));
    return {document_, object.node, found == all_.end() ? nullptr : found->second};
}

}  // namespace fbx_import
