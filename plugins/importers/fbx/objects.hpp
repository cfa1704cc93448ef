// objects.hpp -- the objects of a file and their connections.
#pragma once
#include <string>
#include <unordered_map>
#include <vector>

#include "document.hpp"

namespace fbx_import {

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

}  // namespace fbx_import
