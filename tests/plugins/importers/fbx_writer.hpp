// fbx_writer.hpp -- writes small FBX files for tests: the same nodes in each form that the format has.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace clarity::test {

struct FbxForm {
    bool binary = true, big_endian = false, deflated = false;
    int version = 7400;
};

// A node: its name, its values, its child nodes. A list of numbers is an array from version 7 on.
struct FbxNode {
    using Value = std::variant<int64_t, double, std::string, std::vector<double>, std::vector<int32_t>>;
    std::string name;
    std::vector<Value> values;
    std::vector<FbxNode> children;
};
inline FbxNode::Value whole(int64_t value) {
    return value;
}
inline FbxNode::Value text(const std::string& value) {
    return value;
}

class FbxWriter {
 public:
    // deflate: packs bytes, for files whose arrays are deflated.
    using Deflate = std::string (*)(const std::string&);
    explicit FbxWriter(const FbxForm& form, Deflate deflate = nullptr) : form_(form), deflate_(deflate) {}

    std::string file(const std::vector<FbxNode>& nodes) const {
        std::string out;
        if (!form_.binary) {
            out = "; FBX " + std::to_string(form_.version / 1000) + "." + std::to_string(form_.version / 100 % 10) +
                  ".0 project file\n";
            for (const FbxNode& node : nodes) out += line(node, 0);
            return out;
        }
        out = std::string("Kaydara FBX Binary  \0\x1A", 22) + char(form_.big_endian);
        out += bytes(static_cast<uint32_t>(form_.version));
        for (const FbxNode& node : nodes) out += record(node, out.size());
        return out + std::string(3 * word() + 1, '\0');
    }

 private:
    size_t word() const { return form_.version >= 7500 ? 8 : 4; }
    template <class T>
    std::string bytes(T value) const {
        std::string out(sizeof value, '\0');
        std::memcpy(out.data(), &value, sizeof value);
        return form_.big_endian ? std::string(out.rbegin(), out.rend()) : out;
    }
    std::string offset(size_t value) const {
        return word() == 8 ? bytes(static_cast<uint64_t>(value)) : bytes(static_cast<uint32_t>(value));
    }
    template <class T>
    std::string array(char type, const std::vector<T>& values, size_t& count) const {
        std::string out, plain;
        for (const T& value : values) {
            plain += bytes(value);
            out += (type == 'd' ? 'D' : 'I') + bytes(value);
        }
        if (form_.version < 7000) {  // each number is a value
            count += values.size() - 1;
            return out;
        }
        const bool pack = form_.deflated && deflate_;
        const std::string stored = pack ? deflate_(plain) : plain;
        return type + bytes(static_cast<uint32_t>(values.size())) + bytes(uint32_t(pack)) +
               bytes(static_cast<uint32_t>(stored.size())) + stored;
    }
    std::string record(const FbxNode& node, size_t at) const {
        std::string values, children;
        size_t count = node.values.size();
        for (const FbxNode::Value& value : node.values) {
            if (const auto* i = std::get_if<int64_t>(&value)) values += 'L' + bytes(*i);
            if (const auto* d = std::get_if<double>(&value)) values += 'D' + bytes(*d);
            if (const auto* s = std::get_if<std::string>(&value)) {
                std::string name = *s;  // "Model::Cube" is Cube, 0, 1, Model
                const size_t colons = name.find("::");
                if (colons != name.npos) name = name.substr(colons + 2) + std::string("\0\1", 2) + name.substr(0, colons);
                values += 'S' + bytes(static_cast<uint32_t>(name.size())) + name;
            }
            if (const auto* list = std::get_if<std::vector<double>>(&value)) values += array('d', *list, count);
            if (const auto* list = std::get_if<std::vector<int32_t>>(&value)) values += array('i', *list, count);
        }
        const size_t head = 3 * word() + 1, first_child = at + head + node.name.size() + values.size();
        for (const FbxNode& child : node.children) children += record(child, first_child + children.size());
        if (!node.children.empty()) children += std::string(head, '\0');
        return offset(first_child + children.size()) + offset(count) + offset(values.size()) + char(node.name.size()) +
               node.name + values + children;
    }
    template <class T>
    static std::string listed(const std::vector<T>& values) {
        std::string out;
        for (const T& value : values) out += (out.empty() ? "" : ",") + std::to_string(value);
        return out;
    }
    std::string line(const FbxNode& node, int depth) const {
        const std::string indent(static_cast<size_t>(depth), '\t');
        std::string out = indent + node.name + ": ", array;
        for (const FbxNode::Value& value : node.values) {
            if (&value != &node.values[0]) out += ", ";
            if (const auto* i = std::get_if<int64_t>(&value)) out += std::to_string(*i);
            if (const auto* d = std::get_if<double>(&value)) out += std::to_string(*d);
            if (const auto* s = std::get_if<std::string>(&value)) out += '"' + *s + '"';
            size_t count = 0;
            if (const auto* list = std::get_if<std::vector<double>>(&value)) array = listed(*list), count = list->size();
            if (const auto* list = std::get_if<std::vector<int32_t>>(&value)) array = listed(*list), count = list->size();
            if (count > 0) out += form_.version < 7000 ? array : "*" + std::to_string(count);
        }
        if (form_.version < 7000) array.clear();
        if (node.children.empty() && array.empty()) return out + "\n";
        out += " {\n";
        if (!array.empty()) out += indent + "\ta: " + array + "\n";
        for (const FbxNode& child : node.children) out += line(child, depth + 1);
        return out + indent + "}\n";
    }
    const FbxForm form_;
    const Deflate deflate_;
};

}  // namespace clarity::test
