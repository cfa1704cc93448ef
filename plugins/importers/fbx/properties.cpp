#include "properties.hpp"

#include <algorithm>
#include <unordered_set>

namespace fbx_import {
namespace {

// Binary files write "Cube", 0, 1, "Model". Source: Blender developer blog.
constexpr std::string_view kSeparator{"\0\1", 2};

// The text with &quot; &lf; &cr; and &amp; replaced. Measured from max_quote_6100_ascii.
std::string without_entities(std::string_view text) {
    constexpr std::pair<std::string_view, char> entities[] = {{"&quot;", '"'}, {"&lf;", '\n'}, {"&cr;", '\r'}, {"&amp;", '&'}};
    std::string out;
    while (!text.empty()) {
        const auto* const found = std::find_if(std::begin(entities), std::end(entities), [&](const auto& entity) {
            return text.substr(0, entity.first.size()) == entity.first;
        });
        const bool is_entity = found != std::end(entities);
        out += is_entity ? found->second : text[0];
        text.remove_prefix(is_entity ? found->first.size() : 1);
    }
    return out;
}

}  // namespace

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

std::string plain_name(const Document& document, std::string_view name) {
    const size_t colons = name.find("::");
    if (!document.is_binary() && colons != name.npos) name.remove_prefix(colons + 2);
    std::string out = document.is_binary() ? std::string(name.substr(0, name.find(kSeparator))) : without_entities(name);
    std::replace_if(out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7F; }, ' ');
    return out;
}

Objects::Objects(const Document& document) : document_(document) {
    all_.emplace_back();
    by_id_[0] = kRoot;
    by_name_["Model::Scene"] = by_name_[std::string_view("Scene\0\1Model", 12)] = kRoot;
    settings_ = document.child(&document.root(), "GlobalSettings");
    const Node* objects = document.child(&document.root(), "Objects");
    if (objects && !settings_) settings_ = document.child(objects, "GlobalSettings");  // version 6
    // Up to version 5.8, objects stand in the file's top level (measured from max7_skin_5000_binary).
    add_all(objects ? *objects : document.root());
    connect();
    for (const uint32_t model : objects ? std::vector<uint32_t>() : of_kind("Model")) connect_oldest(model);
    below_.resize(all_.size());
    above_.resize(all_.size());
    for (const Link& link : links_) {
        below_[link.to].push_back(&link);
        above_[link.from].push_back(&link);
    }
}

void Objects::add_all(const Node& parent) {
    for (const Node& node : document_.children(parent)) {
        if (node.first_child != 0 || document_.value(node, 1).kind == Value::string) add(node);  // a layer's block may be empty
    }
}

// From version 7.0 on: an id, the name with its class, the type. Before: the name with its class, the type; the name is the id.
// Where objects share an id or a name, connections mean the first one. A further model of the same name cannot be reached by
// any connection: the first one is then shown as often as it is connected (max_quote_6100_ascii and its truth).
void Objects::add(const Node& node) {
    const Value first = document_.value(node, 0);
    const bool has_id = first.kind == Value::integer;
    const size_t name_at = has_id ? 1 : 0;
    const uint32_t index = static_cast<uint32_t>(all_.size());
    const std::string_view name = document_.text(&node, name_at);
    Object object;
    object.node = &node;
    object.kind = node.name;
    object.type = document_.text(&node, name_at + 1);
    if (object.type.empty()) object.type = document_.text(&node, "Type");
    object.name = plain_name(document_, name);
    all_.push_back(object);
    if (has_id) {
        by_id_.emplace(first.whole, index);
        return;
    }
    const auto [known, is_first] = by_name_.emplace(name, index);
    if (!is_first && object.kind == "Model") {
        all_[known->second].has_namesakes = true;
        all_.back().kind = "Model again";
    }
    // A model's camera, light or mesh is part of it, and has a second name (measured from maya_node_attribute_zoo_6100_binary).
    const std::string_view inner = document_.text(&node, "NodeAttributeName");
    if (!inner.empty()) by_name_.emplace(inner, index);
}

uint32_t Objects::find(std::string_view name) const {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? kNoObject : found->second;
}

// "OO": object to object, "OP": object to property, "PO", "PP": from a property. Source: Blender developer blog; "PO" from the
// FBX SDK help, "FbxConnection".
void Objects::connect() {
    const Node* list = document_.child(&document_.root(), "Connections");
    if (!list) return;
    std::unordered_set<uint64_t> known;
    for (const Node& node : document_.children(*list)) {
        if (node.name != "C" && node.name != "Connect") continue;
        const std::string_view kind = document_.text(&node, 0);
        if (kind.size() != 2) continue;
        const auto end = [&](size_t i) {
            const Value v = document_.value(node, i);
            if (v.kind == Value::string) return find(v.text);
            const auto found = by_id_.find(v.whole);
            return v.kind == Value::integer && found != by_id_.end() ? found->second : kNoObject;
        };
        Link link;
        size_t i = 1;
        link.from = end(i++);
        if (kind[0] == 'P') link.from_property = document_.text(&node, i++);
        link.to = end(i++);
        if (kind[1] == 'P') link.property = document_.text(&node, i);
        if (link.from == kNoObject || link.to == kNoObject || link.from == kRoot) continue;
        // A second connection between the same ids means nothing. Where names are ids, it belongs to another object of
        // the same name.
        const bool is_new = known.insert(uint64_t(link.from) << 32 | link.to).second;
        if (kind == "OO" && !is_new && document_.value(node, 1).kind == Value::integer) continue;
        links_.push_back(link);
    }
}

// Up to version 5.8, a model names its children, and its materials are blocks of it (measured from max7_skin_5000_binary and
// max2009_blob_5800_ascii).
void Objects::connect_oldest(uint32_t parent) {
    const Node& node = *all_[parent].node;
    for (const Node& block : document_.children(node)) {
        if (block.name != "Material" || !block.first_child) continue;
        links_.push_back({static_cast<uint32_t>(all_.size()), parent, {}, {}});
        add(block);
    }
    const Node* list = document_.child(&node, "Children");
    if (!list) return;
    Values values(document_, *list);
    for (Value v; values.next(v);) {
        const uint32_t child = find(v.text);
        if (child != kNoObject && child != kRoot) links_.push_back({child, parent, {}, {}});
    }
}

std::vector<uint32_t> Objects::below(uint32_t object, std::string_view kind, std::string_view type) const {
    std::vector<uint32_t> out;
    for (const Link* link : below(object)) {
        const Object& found = all_[link->from];
        if (!link->property.empty() || !link->from_property.empty()) continue;
        if (found.kind == kind && (type.empty() || found.type == type)) out.push_back(link->from);
    }
    return out;
}

std::vector<uint32_t> Objects::of_kind(std::string_view kind) const {
    std::vector<uint32_t> out;
    for (uint32_t i = 1; i < all_.size(); ++i) {
        if (all_[i].kind == kind) out.push_back(i);
    }
    return out;
}

}  // namespace fbx_import
