// document.hpp -- an FBX file as a tree of named nodes with values. It knows how files are written, not what they mean.
//
// Nodes, values and arrays are views into the file's bytes and are decoded when asked for. No count, length or offset of the
// file is trusted: each is compared with the bytes that are there before it is used.
#pragma once
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace fbx_import {

// The file is damaged. The text says where, what was found, and what was expected.
struct Broken : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// The start of a text of the file, in quotes, for messages. Characters that cannot be printed become '?'.
std::string quoted(std::string_view text);

struct Node {
    std::string_view name;
    std::string_view values;             // in binary files the records of the values, in ASCII files their text
    uint32_t value_count = 0;            // in binary files, as declared
    uint32_t first_child = 0, next = 0;  // numbers of nodes; 0: none
};

struct Value {
    enum Kind { none, integer, real, string, array } kind = none;
    int64_t whole = 0;      // an integer's; of an ASCII array, how many values it declares
    double number = 0;      // an integer's or real's
    std::string_view text;  // a string's or raw data; of an array, all bytes behind its type
    char type = 0;          // in binary files, the letter of the type
    bool is_number() const { return kind == integer || kind == real; }
};

class Document {
 public:
    // Reads the tree. The bytes must outlive the document. Throws Broken.
    explicit Document(std::string_view bytes);

    int version() const { return version_; }  // 7400; 0: the file does not say
    bool is_binary() const { return binary_; }
    bool is_big_endian() const { return big_endian_; }

    struct Children;
    Children children(const Node& node) const;
    const Node& root() const { return nodes_[0]; }
    // The first child of this name, and with this text as its first value if one is given; nullptr if there is none, or no
    // node.
    const Node* child(const Node* node, std::string_view name, std::optional<std::string_view> first_text = {}) const;

    // The i-th value; kind is `none` if there are fewer. Throws Broken.
    Value value(const Node& node, size_t i) const;
    int64_t integer(const Node* node, size_t i, int64_t otherwise) const;
    double number(const Node* node, size_t i, double otherwise) const;
    std::string_view text(const Node* node, size_t i) const;
    // The first text of the node's child `name`.
    std::string_view text(const Node* node, std::string_view name) const { return text(child(node, name), 0); }

    // All numbers of a node: its array, or its values one by one. T: float, double, int32_t or int64_t; numbers that do not fit
    // become the nearest one that does. Throws Broken.
    template <class T>
    std::vector<T> numbers(const Node* node) const;
    // The numbers of the node's child `name`.
    template <class T>
    std::vector<T> numbers(const Node* node, std::string_view name) const {
        return numbers<T>(child(node, name));
    }
    // How many numbers a node has: the count that it declares, or an estimate.
    uint64_t count(const Node& node) const;
    // The bytes of all texts and raw data. Those of ASCII files are decoded from base64.
    std::string content(const Node& node) const;

    // Throws Broken with the place: "line 12: " or "byte 3456: ".
    [[noreturn]] void fail(const char* at, const std::string& what) const;
    [[noreturn]] void fail(const Node& node, const std::string& what) const { fail(node.name.data(), what); }

 private:
    friend class Values;
    class AsciiReader;
    void read_header();
    void read_ascii();
    // Reads the child nodes of `parent` in a binary file, from `at` up to an empty record or `end`. Returns where it stopped.
    size_t read_records(size_t at, size_t end, uint32_t parent, int depth);
    // Adds a node behind `last`, the last child of `parent` so far; 0: there is none. Returns its number.
    uint32_t add_node(std::string_view name, uint32_t parent, uint32_t last, int depth);
    template <class T>
    std::vector<T> binary_array(const Node& node, const Value& array) const;
    template <class T>
    std::vector<T> text_array(const Node& node, size_t declared) const;

    std::string_view bytes_;
    bool binary_ = false, big_endian_ = false;
    int version_ = 0;
    std::vector<Node> nodes_ = std::vector<Node>(1);
};

// The child nodes of a node, for range-based loops: the range is its own iterator.
struct Document::Children {
    const Document* document;
    uint32_t at;
    Children begin() const { return *this; }
    Children end() const { return {document, 0}; }
    const Node& operator*() const { return document->nodes_[at]; }
    void operator++() { at = document->nodes_[at].next; }
    bool operator!=(const Children& other) const { return at != other.at; }
};
inline Document::Children Document::children(const Node& node) const {
    return {this, node.first_child};
}

// The values of a node, one after the other.
class Values {
 public:
    Values(const Document& document, const Node& node) : document_(document), node_(node), rest_(node.values) {}
    // False: there are no more. Throws Broken.
    bool next(Value& value) { return document_.is_binary() ? next_binary(value) : next_ascii(value); }

 private:
    bool next_binary(Value& value);
    bool next_ascii(Value& value);
    const Document& document_;
    const Node& node_;
    std::string_view rest_;
    uint32_t taken_ = 0;
};

}  // namespace fbx_import
