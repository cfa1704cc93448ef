#include "fbx_outline.hpp"

#include <charconv>
#include <cstring>

namespace assimp_import {
namespace {

// One value of a record: a text or a number.
struct Value {
    std::string_view text;
    double number = 0;
    int64_t integer = 0;
};

// Takes records in the order of the file and keeps those that belong to the outline.
class Collector {
 public:
    // Takes one record; depth 0 is the top level. Returns true if the children of the record are needed.
    bool record(int depth, std::string_view name, const std::vector<Value>& values) {
        if (depth == 0) {
            section_ = name == "Objects"       ? Section::objects
                       : name == "Connections" ? Section::connections
                       : name == "Definitions" ? Section::definitions
                                               : Section::other;
            return section_ != Section::other;
        }
        if (section_ == Section::definitions) return definition(depth, name, values);
        if (section_ == Section::connections) {
            if (name != "C" || values.size() < 3) return false;
            const bool is_property = values[0].text == "OP";
            if (!is_property && values[0].text != "OO") return false;
            if (is_property && (values.size() < 4 || values[3].text != "DiffuseColor")) return false;
            connections_.push_back({values[1].integer, values[2].integer, is_property});
            return false;
        }
        if (depth == 1) return object(name, values);
        if (depth == 2) {
            if (texture_ && name == "RelativeFilename" && !values.empty()) *texture_ = std::string(values[0].text);
            return name == "Properties70";
        }
        if (depth == 3 && name == "P" && values.size() >= 5) property(values);
        return false;
    }

    FbxOutline take() {
        for (const auto& [from, to, is_property] : connections_) {
            const auto parent = outline_.models.find(to);
            if (is_property) {
                const auto material = outline_.materials.find(to);
                const auto texture = textures_.find(from);
                if (material != outline_.materials.end() && texture != textures_.end())
                    material->second.texture = texture->second;
                continue;
            }
            if (outline_.models.count(from)) {
                if (to == 0) outline_.roots.push_back(from);
                if (parent != outline_.models.end()) parent->second.children.push_back(from);
            }
            if (outline_.materials.count(from) && parent != outline_.models.end()) parent->second.materials.push_back(from);
        }
        return std::move(outline_);
    }

 private:
    enum class Section { other, definitions, objects, connections };
    struct Connection {
        int64_t from, to;
        bool is_property;  // a connection to the property "DiffuseColor"
    };
    // An object's name is "Name\0\1Model" in binary files and "Model::Name" in text files.
    static std::string object_name(std::string_view text) {
        if (const size_t end = text.find('\0'); end != text.npos) return std::string(text.substr(0, end));
        if (const size_t colons = text.find("::"); colons != text.npos) return std::string(text.substr(colons + 2));
        return std::string(text);
    }
    // Reads the default properties of a Model: ObjectType "Model" > PropertyTemplate > Properties70.
    bool definition(int depth, std::string_view name, const std::vector<Value>& values) {
        if (depth == 1) return name == "ObjectType" && !values.empty() && values[0].text == "Model";
        if (depth < 4) return name == "PropertyTemplate" || name == "Properties70";
        if (name != "P" || values.size() < 5) return false;
        if (values[0].text == "RotationActive") template_.rotation_active = values[4].number != 0;
        if (values[0].text == "RotationOrder") template_.rotation_order = static_cast<int>(values[4].number);
        return false;
    }
    bool object(std::string_view kind, const std::vector<Value>& values) {
        model_ = nullptr;
        material_ = nullptr;
        texture_ = nullptr;
        if (values.size() < 2) return false;
        if (kind == "Model") {
            model_ = &(outline_.models[values[0].integer] = template_);
            model_->name = object_name(values[1].text);
        } else if (kind == "Material") {
            material_ = &outline_.materials[values[0].integer];
            material_->name = object_name(values[1].text);
        } else if (kind == "Texture") {
            texture_ = &textures_[values[0].integer];
        }
        return model_ || material_ || texture_;
    }
    // A property record: {name, type, label, flags, value...}.
    void property(const std::vector<Value>& values) {
        std::array<double, 3> numbers{};
        for (size_t k = 0; k < 3 && 4 + k < values.size(); ++k) numbers[k] = values[4 + k].number;
        const std::string_view name = values[0].text;
        if (material_) material_->properties[std::string(name)] = numbers;
        if (!model_) return;
        if (name == "RotationOrder") model_->rotation_order = static_cast<int>(numbers[0]);
        if (name == "RotationActive") model_->rotation_active = numbers[0] != 0;
        if (name == "GeometricRotation") model_->geometric_rotation = numbers;
        if (name == "Lcl Translation") model_->translation = numbers;
        if (name == "Lcl Rotation") model_->rotation = numbers;
        if (name == "Lcl Scaling") model_->scaling = numbers;
    }

    FbxOutline outline_;
    FbxOutline::Model template_;
    FbxOutline::Model* model_ = nullptr;
    Section section_ = Section::other;
    FbxOutline::Material* material_ = nullptr;
    std::string* texture_ = nullptr;
    std::unordered_map<int64_t, std::string> textures_;
    std::vector<Connection> connections_;
};

// ---- binary files
// Records are {end, value count, value bytes, name length, name, values, children}. The offsets have 32 bits, from version 7.5
// on 64 bits.

class BinaryReader {
 public:
    explicit BinaryReader(std::string_view bytes) : bytes_(bytes), is_wide_(version() >= 7500) {}

    void read(Collector& collector) {
        size_t at = 27;
        std::vector<size_t> ends;  // ends of the enclosing records
        std::vector<Value> values;
        while (at < bytes_.size()) {
            const size_t head = is_wide_ ? 25 : 13;
            if (bytes_.size() - at < head) return;
            const uint64_t end = offset(at), count = offset(at + (is_wide_ ? 8 : 4)),
                           value_bytes = offset(at + (is_wide_ ? 16 : 8));
            if (end == 0) {  // mark at the end of the children
                if (ends.empty()) return;
                at = ends.back();
                ends.pop_back();
                continue;
            }
            const size_t name_length = static_cast<unsigned char>(bytes_[at + head - 1]), name = at + head;
            const size_t first = name + name_length;
            if (end <= at || end > bytes_.size() || first > end || value_bytes > end - first || ends.size() > 8) return;
            read_values(first, static_cast<size_t>(first + value_bytes), count, values);
            const bool enter = collector.record(static_cast<int>(ends.size()), bytes_.substr(name, name_length), values);
            if (enter && first + value_bytes < end) {
                ends.push_back(static_cast<size_t>(end));
                at = static_cast<size_t>(first + value_bytes);
            } else {
                at = static_cast<size_t>(end);
            }
        }
    }

 private:
    uint32_t version() const { return bytes_.size() < 27 ? 0 : load<uint32_t>(23); }
    template <class T>
    T load(size_t at) const {
        T value;
        std::memcpy(&value, bytes_.data() + at, sizeof value);
        return value;
    }
    uint64_t offset(size_t at) const { return is_wide_ ? load<uint64_t>(at) : load<uint32_t>(at); }

    // Reads numbers and strings. Stops at the first array, or at a value that does not fit.
    void read_values(size_t at, size_t end, uint64_t count, std::vector<Value>& values) const {
        values.clear();
        while (values.size() < count && values.size() < 8 && at < end) {
            const char type = bytes_[at++];
            const size_t size = type == 'C'                                 ? 1
                                : type == 'Y'                               ? 2
                                : type == 'I' || type == 'F' || type == 'S' ? 4
                                : type == 'L' || type == 'D'                ? 8
                                                                            : 0;
            if (size == 0 || end - at < size) return;
            Value value;
            if (type == 'C') value.integer = bytes_[at];
            if (type == 'Y') value.integer = load<int16_t>(at);
            if (type == 'I') value.integer = load<int32_t>(at);
            if (type == 'L') value.integer = load<int64_t>(at);
            value.number = static_cast<double>(value.integer);
            if (type == 'F') value.number = load<float>(at);
            if (type == 'D') value.number = load<double>(at);
            if (type == 'S') {
                const uint32_t length = load<uint32_t>(at);
                if (length > end - at - 4) return;
                value.text = bytes_.substr(at + 4, length);
                at += length;
            }
            at += size;
            values.push_back(value);
        }
    }

    std::string_view bytes_;
    bool is_wide_;
};

// ---- text files
// A record is `Name: value, value {` on one line.

class TextReader {
 public:
    explicit TextReader(std::string_view text) : rest_(text) {}

    void read(Collector& collector) {
        int depth = 0, wanted = 0;  // wanted: records down to this depth are needed
        std::vector<Value> values;
        while (!rest_.empty()) {
            const size_t end = rest_.find('\n');
            std::string_view line = rest_.substr(0, end);
            rest_.remove_prefix(end == rest_.npos ? rest_.size() : end + 1);
            const size_t start = line.find_first_not_of(" \t\r");
            if (start == line.npos || line[start] == ';') continue;
            line.remove_prefix(start);
            if (line[0] == '}') {
                if (depth > 0) --depth;
                wanted = wanted < depth ? wanted : depth;
                continue;
            }
            const size_t colon = line.find(':');
            const bool opens = opens_block(line);
            if (depth <= wanted && colon != line.npos && colon < 64) {
                read_values(line.substr(colon + 1), values);
                if (collector.record(depth, line.substr(0, colon), values) && opens) wanted = depth + 1;
            }
            if (opens) ++depth;
        }
    }

 private:
    static bool opens_block(std::string_view line) {
        const size_t last = line.find_last_not_of(" \t\r");
        return last != line.npos && line[last] == '{';
    }
    static void read_values(std::string_view text, std::vector<Value>& values) {
        values.clear();
        while (values.size() < 8) {
            const size_t start = text.find_first_not_of(" \t\r,{");
            if (start == text.npos) return;
            text.remove_prefix(start);
            Value value;
            size_t end = 0;
            if (text[0] == '"') {
                end = text.find('"', 1);
                if (end == text.npos) return;
                value.text = text.substr(1, end - 1);
                ++end;
            } else {
                end = text.find_first_of(" \t\r,{");
                const std::string_view word = text.substr(0, end);
                std::from_chars(word.data(), word.data() + word.size(), value.integer);
                std::from_chars(word.data(), word.data() + word.size(), value.number);
            }
            values.push_back(value);
            text.remove_prefix(end == text.npos ? text.size() : end);
        }
    }

    std::string_view rest_;
};

}  // namespace

FbxOutline read_fbx_outline(std::string_view bytes) {
    Collector collector;
    if (bytes.substr(0, 18) == "Kaydara FBX Binary") {
        BinaryReader(bytes).read(collector);
    } else {
        TextReader(bytes).read(collector);
    }
    return collector.take();
}

}  // namespace assimp_import
