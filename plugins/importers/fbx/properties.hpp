// properties.hpp -- the properties of an object. Those that it does not have itself are in the template of its class.
#pragma once
#include <string>
#include <unordered_map>
#include <vector>

#include "../common/matrix.hpp"
#include "document.hpp"

namespace fbx_import {

// The objects of a file and their connections.
inline constexpr uint32_t kRoot = 0, kNoObject = 0xFFFFFFFFu;

struct Object {
    const Node* node = nullptr;  // nullptr: the root of the scene
    std::string_view kind;       // "Model", "Geometry", "Material"
    std::string_view type;       // "Mesh", "Camera", "Skin"
    std::string name;
    bool has_namesakes = false;  // further models have the same name, which is their id
};

// `from` hangs from `to`, or from its property.
struct Link {
    uint32_t from = kNoObject, to = kNoObject;
    std::string_view property, from_property;
};

class Objects {
 public:
    explicit Objects(const Document& document);

    size_t size() const { return all_.size(); }
    const Object& operator[](uint32_t object) const { return all_[object]; }
    uint32_t find(std::string_view name) const;  // by name as the file writes it; before version 7 only
    // The connections to the objects below an object, and to those above it, in the order of the file.
    const std::vector<const Link*>& below(uint32_t object) const { return below_[object]; }
    const std::vector<const Link*>& above(uint32_t object) const { return above_[object]; }
    // Objects of this kind that hang from the object itself, not from a property; `type` "" stands for any.
    std::vector<uint32_t> below(uint32_t object, std::string_view kind, std::string_view type = "") const;
    std::vector<uint32_t> of_kind(std::string_view kind) const;

    // The file's settings: unit, axes, time.
    const Node* settings() const { return settings_; }

 private:
    void add(const Node& node);
    void add_all(const Node& parent);
    void connect();
    void connect_oldest(uint32_t parent);

    const Document& document_;
    std::vector<Object> all_;
    std::unordered_map<int64_t, uint32_t> by_id_;
    std::unordered_map<std::string_view, uint32_t> by_name_;
    std::vector<Link> links_;
    std::vector<std::vector<const Link*>> below_, above_;  // of each object
    const Node* settings_ = nullptr;
};

// The name without its class, which stands before it in ASCII files ("Model::Cube") and behind it in binary ones.
std::string plain_name(const Document& document, std::string_view name);

using namespace importers;

class Properties {
 public:
    Properties(const Document& document, const Node* object, const Node* defaults = nullptr);
    bool has(std::string_view name) const { return find(name).node != nullptr; }
    double number(std::string_view name, double otherwise) const {
        const auto [node, first] = find(name);
        return document_.number(node, first, otherwise);
    }
    int64_t whole(std::string_view name, int64_t otherwise) const {
        const auto [node, first] = find(name);
        return document_.integer(node, first, otherwise);
    }
    std::string_view text(std::string_view name) const {
        const auto [node, first] = find(name);
        return document_.text(node, first);
    }
    Vec3 vector(std::string_view name, const Vec3& otherwise) const;
    // Calls body(name) for each property of a list.
    template <class Body>
    void each(const Body& body) const {
        for (const auto& place : places_) body(place.first);
    }

 private:
    struct Place {
        const Node* node = nullptr;
        size_t first = 0;  // number of its first value
    };
    void add(const Node* list);
    Place find(std::string_view name) const;
    const Document& document_;
    const Node* object_;
    std::unordered_map<std::string_view, Place> places_;
};

// The properties that objects have unless they state others.
class Templates {
 public:
    explicit Templates(const Document& document);
    // The properties of an object, and of its template.
    Properties of(const Object& object) const;

 private:
    const Document& document_;
    std::unordered_map<std::string, const Node*> all_;  // by class of objects, "Model", or "FbxLight" for node attributes
};

}  // namespace fbx_import
