// properties.hpp -- the properties of an object. Those that it does not have itself are in the template of its class.
#pragma once
#include <unordered_map>

#include "../common/matrix.hpp"
#include "objects.hpp"

namespace fbx_import {

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
