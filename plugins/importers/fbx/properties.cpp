#include "properties.hpp"

namespace fbx_import {

// Version 7: `Properties70`, each `P: "name", "type", "label", "flags", values`. Version 6: `Properties60`, each
// `Property: "name", "type", "flags", values`. Before: children of the object by their names. Source: Blender developer blog;
// measured from max_quote_6100_ascii and max2009_blob_5800_ascii.
Properties::Properties(const Document& document, const Node* object, const Node* defaults)
    : document_(document), object_(object) {
    add(object);
    add(defaults);
}

void Properties::add(const Node* owner) {
    for (const char* name : {"Properties70", "Properties60"}) {
        const Node* list = document_.child(owner, name);
        if (!list) continue;
        for (const Node& node : document_.children(*list)) {
            const bool is_new = node.name == "P";
            if (is_new || node.name == "Property") places_.emplace(document_.text(&node, 0), Place{&node, is_new ? 4u : 3u});
        }
    }
}

Properties::Place Properties::find(std::string_view name) const {
    const auto found = places_.find(name);
    return found != places_.end() ? found->second : Place{document_.child(object_, name), 0};
}

double Properties::number(std::string_view name, double otherwise) const {
    const Place place = find(name);
    return document_.number(place.node, place.first, otherwise);
}

int64_t Properties::whole(std::string_view name, int64_t otherwise) const {
    const Place place = find(name);
    return document_.integer(place.node, place.first, otherwise);
}

Vec3 Properties::vector(std::string_view name, const Vec3& otherwise) const {
    const Place place = find(name);
    Vec3 out = otherwise;
    for (size_t k = 0; k < 3; ++k) out[k] = document_.number(place.node, place.first + k, otherwise[k]);
    return out;
}

std::string_view Properties::text(std::string_view name) const {
    const Place place = find(name);
    return document_.text(place.node, place.first);
}

// `Definitions: ObjectType: "Model" { PropertyTemplate: "FbxNode" { Properties70 } }`. Node attributes have one for each type:
// "FbxLight", "FbxCamera". Source: Blender developer blog; measured from motionbuilder_lights_7700_ascii.
Templates::Templates(const Document& document) : document_(document) {
    const Node* definitions = document.child(&document.root(), "Definitions");
    if (!definitions) return;
    for (const Node& type : document.children(*definitions)) {
        if (type.name != "ObjectType") continue;
        for (const Node& found : document.children(type)) {
            if (found.name != "PropertyTemplate") continue;
            by_class_.emplace(document.text(&type, 0), &found);
            by_name_.emplace(document.text(&found, 0), &found);
        }
    }
}

Properties Templates::of(const Object& object) const {
    const Node* found = nullptr;
    if (object.kind == "NodeAttribute") {
        const auto at = by_name_.find("Fbx" + std::string(object.type));
        if (at != by_name_.end()) found = at->second;
    } else {
        const auto at = by_class_.find(object.kind);
        if (at != by_class_.end()) found = at->second;
    }
    return {document_, object.node, found};
}

}  // namespace fbx_import
