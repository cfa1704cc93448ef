#include "document.hpp"

#include <algorithm>

#include "../common/file_kind.hpp"
#include "../common/text_lines.hpp"
#include "binary.hpp"

namespace fbx_import {

Document::Document(std::string_view bytes) : bytes_(bytes) {
    read_header();
    if (binary_) {
        read_records(kHeaderBytes, bytes_.size(), 0, 0);
    } else {
        read_ascii();
    }
    // Up to FBX 5, the header of a binary file has the version of the container: 3000 where FBXVersion says 5000 (measured
    // from max7_cube_5000_binary). From 5.8 on, both are the same.
    const int64_t stated = integer(child(child(&root(), "FBXHeaderExtension"), "FBXVersion"), 0, version_);
    version_ = static_cast<int>(std::clamp<int64_t>(stated, 0, 99999));
    // Some ASCII files state no version (measured from synthetic_missing_version_6100_ascii). Connections have ids from 7.0 on.
    if (version_ == 0 && !binary_) {
        const Node* connections = child(&root(), "Connections");
        version_ = connections && child(connections, "C") ? 7000 : connections ? 6000 : 5000;
    }
}

void Document::read_header() {
    const auto starts = [&](std::string_view start) { return bytes_.substr(0, start.size()) == start; };
    if (bytes_.empty()) throw Broken("the file is empty");
    binary_ = starts(kMagic.substr(0, 18));
    const char* kind = importers::kind_of(bytes_);
    if (kind && !binary_) throw Broken(std::string("not an FBX file but ") + kind);
    if (!binary_) {
        const std::string_view head = bytes_.substr(0, 4096);
        if (head.find("FBX") == head.npos) throw Broken("not an FBX file: neither the binary nor the text header is there");
        // In very old files only a comment says the version: `; FBX 5.8.0 project file`.
        const size_t key = head.find("FBX ");
        const auto digit = [&](size_t i) { return key + i < head.size() && head[key + i] >= '0' && head[key + i] <= '9'; };
        if (key != head.npos && digit(4)) version_ = (head[key + 4] - '0') * 1000;
        if (version_ != 0 && digit(6)) version_ += (head[key + 6] - '0') * 100;
        return;
    }
    if (bytes_.size() < kHeaderBytes || !starts(kMagic) || static_cast<unsigned char>(bytes_[kVersionAt - 1]) > 1) {
        throw Broken(
            "byte 18: the header of this binary FBX file is damaged (was it transferred as text?): fetch or export it again");
    }
    big_endian_ = bytes_[kVersionAt - 1] == 1;
    version_ = static_cast<int>(std::min(load<uint32_t>(bytes_.data() + kVersionAt, big_endian_), 99999u));
}

std::string quoted(std::string_view text) {
    text = text.substr(0, std::min(text.find_first_of("\r\n"), size_t(40)));
    std::string out = "'";
    for (const char c : text) out += c < ' ' || c > '~' ? '?' : c;
    return out + "'";
}

const Node* Document::child(const Node* node, std::string_view name, std::optional<std::string_view> first_text) const {
    if (!node) return nullptr;
    for (const Node& child : children(*node)) {
        if (child.name == name && (!first_text || text(&child, 0) == *first_text)) return &child;
    }
    return nullptr;
}

Value Document::value(const Node& node, size_t i) const {
    Values values(*this, node);
    Value value;
    while (values.next(value) && i > 0) --i;
    return value;
}

int64_t Document::integer(const Node* node, size_t i, int64_t otherwise) const {
    const Value found = node ? value(*node, i) : Value();
    if (found.kind == Value::integer) return found.whole;
    if (found.kind != Value::real || !(found.number > -9e18 && found.number < 9e18)) return otherwise;
    return static_cast<int64_t>(found.number);
}

double Document::number(const Node* node, size_t i, double otherwise) const {
    const Value found = node ? value(*node, i) : Value();
    return found.is_number() ? found.number : otherwise;
}

std::string_view Document::text(const Node* node, size_t i) const {
    const Value found = node ? value(*node, i) : Value();
    return found.kind == Value::string ? found.text : std::string_view();
}

void Document::fail(const char* at, const std::string& what) const {
    size_t number = binary_ ? static_cast<size_t>(at - bytes_.data()) : 1;
    if (!binary_) {
        importers::Lines lines(bytes_);
        for (std::string_view line; lines.next(line) && lines.rest().data() <= at;) ++number;
    }
    throw Broken((binary_ ? "byte " : "line ") + std::to_string(number) + ": " + what);
}

uint32_t Document::add_node(std::string_view name, uint32_t parent, uint32_t last, int depth) {
    if (depth > kMaxDepth)
        fail(name.data(), "blocks are nested more than " + std::to_string(kMaxDepth) + " deep; expected at most that");
    if (nodes_.size() >= kMaxNodes) fail(name.data(), "there are more blocks than can be read");
    const uint32_t index = static_cast<uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_[index].name = name;
    (last ? nodes_[last].next : nodes_[parent].first_child) = index;
    return index;
}

}  // namespace fbx_import
