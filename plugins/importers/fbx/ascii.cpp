// ascii.cpp -- the text form of FBX files.
#include <algorithm>
#include <array>
#include <cstring>

#include "../common/text_lines.hpp"
#include "binary.hpp"

namespace fbx_import {
namespace {

enum Class : uint8_t { other, space, newline, special };  // special: the characters that end a word
constexpr std::array<uint8_t, 256> make_classes() {
    std::array<uint8_t, 256> table{};
    for (const char c : {' ', '\t', '\v', '\f'}) table[static_cast<unsigned char>(c)] = space;
    table['\n'] = table['\r'] = newline;
    for (const char c : {',', '{', '}', '"', ';', '\0'}) table[static_cast<unsigned char>(c)] = special;
    return table;
}
constexpr std::array<uint8_t, 256> kClasses = make_classes();
Class class_of(char c) {
    return static_cast<Class>(kClasses[static_cast<unsigned char>(c)]);
}

// Also skips comments, which reach from a ';' to the end of the line.
const char* skip_space(const char* at, const char* end) {
    for (; at < end; ++at) {
        if (*at == ';') at = std::find_if(at, end, importers::is_line_end);
        if (at == end || (class_of(*at) != space && class_of(*at) != newline)) return at;
    }
    return at;
}
}  // namespace

// `Name: value, value {` children `}`. Values are numbers, words or "texts", with commas in between. `;` begins a comment, but
// not within a text. Programs break long lists where they like: behind a comma, before one (max2009_cube_anim_5800_ascii), or
// without one (Cinema 4D). So values go on in a new line if it looks like one, and end at a brace or at the next name.
class Document::AsciiReader {
 public:
    explicit AsciiReader(Document& document)
        : document_(document), at_(document.bytes_.data()), end_(at_ + document.bytes_.size()) {
        at_ = importers::without_mark(document.bytes_).data();
        // Some programs fill files up with zeros, or end them with the byte 26 of DOS.
        while (end_ > at_ && (end_[-1] == '\0' || end_[-1] == '\x1A')) --end_;
    }
    void read() {
        read_nodes(0, 0);
        if (at_ < end_) document_.fail(at_, "found a '}' without its '{'; expected the name of a block");
    }

 private:
    void read_nodes(uint32_t parent, int depth);
    void skip_values();
    bool goes_back_to_name(const char* values);
    bool goes_on(const char* line) const;
    Document& document_;
    const char *at_, *end_;
};
void Document::read_ascii() {
    AsciiReader(*this).read();
}

void Document::AsciiReader::read_nodes(uint32_t parent, int depth) {
    uint32_t last = 0;
    for (at_ = skip_space(at_, end_); at_ < end_ && *at_ != '}'; at_ = skip_space(at_, end_)) {
        const char* from = at_;
        while (at_ < end_ && *at_ != ':' && class_of(*at_) == other) ++at_;
        const std::string_view name(from, static_cast<size_t>(at_ - from));
        while (at_ < end_ && class_of(*at_) == space) ++at_;
        if (at_ == end_ || *at_ != ':' || name.empty())
            document_.fail(from, "found " + quoted({from, static_cast<size_t>(end_ - from)}) + "; expected a name and ':'");
        last = document_.add_node(name, parent, last, depth);
        const char* values = ++at_;
        skip_values();
        document_.nodes_[last].values = {values, static_cast<size_t>(at_ - values)};
        if (at_ == end_ || *at_ != '{') continue;
        const char* open = at_++;
        read_nodes(last, depth + 1);
        if (at_ == end_) document_.fail(open, "the file ends within this block, " + quoted(name) + "; expected its '}'");
        ++at_;
    }
}

// Moves to the end of a node's values: a '{', a '}', or the next node.
void Document::AsciiReader::skip_values() {
    const char* const values = at_;
    bool after_comma = true;  // Blender 2.79 writes the first key on the next line
    while (at_ < end_) {
        // Long lists of numbers take most of the file.
        while (at_ < end_ && (class_of(*at_) == other || class_of(*at_) == space || *at_ == ',')) {
            if (*at_ == ':' && goes_back_to_name(values)) return;
            if (*at_ == ',' || class_of(*at_) == other) after_comma = *at_ == ',';
            if (*at_++ != ':') continue;
            while (at_ < end_ && class_of(*at_) == other) ++at_;  // names have no colon, so that the word is looked at once
        }
        if (at_ == end_ || *at_ == '{' || *at_ == '}') return;
        if (*at_ == '"') {
            const void* close = std::memchr(at_ + 1, '"', static_cast<size_t>(end_ - at_ - 1));
            if (!close) document_.fail(at_, "found quotes that nothing closes; expected '\"'");
            at_ = static_cast<const char*>(close) + 1;
            after_comma = false;
        } else if (*at_ == '\0') {
            document_.fail(at_, "found a byte 0; expected text");
        } else {  // a new line, or a comment that reaches up to it
            const char* next = skip_space(at_, end_);
            if (!after_comma && !goes_on(next)) return;
            at_ = next;
        }
    }
}

// At a colon: if the word before it is the name of the next node, goes back to its first character. It is one at the start of a
// line, and behind a value without a comma if a space follows: `Version: 232 Shading: T`, but not `FileName: C:\a.png`.
bool Document::AsciiReader::goes_back_to_name(const char* values) {
    const auto skip_back = [&](const char* at, Class what) {
        while (at > values && class_of(at[-1]) == what) --at;
        return at;
    };
    const char *const word_end = skip_back(at_, space), *const word = skip_back(word_end, other);
    const char* const before = skip_back(word, space);
    if (word == word_end || before == values || before[-1] == ',') return false;
    const bool follows_value = class_of(before[-1]) != newline;
    if (follows_value && at_ + 1 < end_ && class_of(at_[1]) == other) return false;
    at_ = word;
    return true;
}

// Whether values go on in a line although no comma stands before it: with a comma, text, number or the letter of a key.
bool Document::AsciiReader::goes_on(const char* line) const {
    if (line == end_ || *line == ',' || *line == '"' || *line == '{') return line < end_;
    double number;
    const char* behind = line;
    if (!importers::read_number(behind, end_, number)) ++behind;
    return behind == end_ || class_of(*behind) != other;
}

bool Values::next_ascii(Value& value) {
    value = Value();
    const char *at = rest_.data(), *end = at + rest_.size();
    at = skip_space(at, end);
    if (at < end && *at == ',') at = skip_space(at + 1, end);
    if (at == end) return false;
    const char* begin = at;
    if (*at == '"') {
        const void* close = std::memchr(at + 1, '"', static_cast<size_t>(end - at - 1));
        const char* stop = close ? static_cast<const char*>(close) : end;
        value.kind = Value::string;
        value.text = {at + 1, static_cast<size_t>(stop - at - 1)};
        at = close ? stop + 1 : end;
    } else if (*at == '*') {  // `*24 {`: the numbers are in a child `a`
        ++at;
        value.kind = Value::array;
        importers::read_number(at, end, value.whole);
    } else if (importers::read_number(at, end, value.whole)) {
        value.kind = Value::integer;
        value.number = static_cast<double>(value.whole);
    } else if (importers::read_number(at, end, value.number)) {
        value.kind = Value::real;
    }
    if (value.kind == Value::none || (at < end && class_of(*at) == other)) {  // a word
        at = begin;
        while (at < end && class_of(*at) == other) ++at;
        value.kind = Value::string;
        value.text = {begin, static_cast<size_t>(at - begin)};
        if (at == begin) ++at;
    }
    rest_ = {at, static_cast<size_t>(end - at)};
    return true;
}

}  // namespace fbx_import
