#include "ascii.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "binary.hpp"

namespace fbx_import {
namespace {

enum Class : uint8_t { other, space, newline, special };  // special: the characters that end a word
constexpr std::array<uint8_t, 256> make_classes() {
    std::array<uint8_t, 256> table{};
    for (const char c : {' ', '\t', '\r', '\v', '\f'}) table[static_cast<unsigned char>(c)] = space;
    table['\n'] = newline;
    for (const char c : {',', '{', '}', '"', ';', '\0'}) table[static_cast<unsigned char>(c)] = special;
    return table;
}
constexpr std::array<uint8_t, 256> kClasses = make_classes();
Class class_of(char c) {
    return static_cast<Class>(kClasses[static_cast<unsigned char>(c)]);
}

const char* skip_line(const char* at, const char* end) {
    const void* found = std::memchr(at, '\n', static_cast<size_t>(end - at));
    return found ? static_cast<const char*>(found) : end;
}
const char* skip_space(const char* at, const char* end) {
    for (; at < end; ++at) {
        if (*at == ';') at = skip_line(at, end);
        if (at == end || (class_of(*at) != space && class_of(*at) != newline)) return at;
    }
    return at;
}

}  // namespace

void AsciiReader::fail(const char* where, const std::string& what) const {
    throw Broken(document_.place(where) + ": " + what);
}

void AsciiReader::read() {
    if (std::string_view(at_, static_cast<size_t>(end_ - at_)).substr(0, 3) == "\xEF\xBB\xBF") at_ += 3;
    read_nodes(0, 0);
    if (at_ < end_) fail(at_, "found a '}' without its '{'; expected the name of a block");
}

void AsciiReader::skip_space() {
    at_ = fbx_import::skip_space(at_, end_);
}

void AsciiReader::read_nodes(uint32_t parent, int depth) {
    std::vector<Node>& nodes = document_.nodes_;
    if (depth > kMaxDepth)
        fail(at_, "blocks are nested more than " + std::to_string(kMaxDepth) + " deep; expected at most that");
    uint32_t last = 0;
    for (skip_space(); at_ < end_ && *at_ != '}'; skip_space()) {
        const char* name = at_;
        while (at_ < end_ && *at_ != ':' && class_of(*at_) == other) ++at_;
        const char* name_end = at_;
        while (at_ < end_ && class_of(*at_) == space) ++at_;
        if (at_ == end_ || *at_ != ':' || name_end == name)
            fail(name, "found " + quoted({name, static_cast<size_t>(end_ - name)}) + "; expected a name and ':'");
        ++at_;
        if (nodes.size() >= kMaxNodes) fail(name, "there are more blocks than can be read");
        const uint32_t index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        nodes[index].name = {name, static_cast<size_t>(name_end - name)};
        (last ? nodes[last].next : nodes[parent].first_child) = index;
        last = index;
        const char* values = at_;
        skip_values();
        nodes[index].values = {values, static_cast<size_t>(at_ - values)};
        if (at_ == end_ || *at_ != '{') continue;
        const char* open = at_++;
        read_nodes(index, depth + 1);
        if (at_ == end_) fail(open, "the file ends within this block, " + quoted(nodes[index].name) + "; expected its '}'");
        ++at_;
    }
}

// Moves to the end of a node's values: a '{', a '}', or the next node.
void AsciiReader::skip_values() {
    bool after_comma = true, crossed_line = false;  // Blender 2.79 writes the first key on the next line
    while (at_ < end_) {
        // Long lists of numbers take most of the file.
        while (at_ < end_ && (class_of(*at_) == other || class_of(*at_) == space || *at_ == ',')) {
            if (*at_ == ':' && crossed_line) {  // this line is the next node: go back to its name
                while (class_of(at_[-1]) == other) --at_;
                return;
            }
            if (*at_ == ',' || class_of(*at_) == other) after_comma = *at_ == ',';
            if (*at_ == ',') crossed_line = false;
            ++at_;
        }
        if (at_ == end_ || *at_ == '{' || *at_ == '}') return;
        if (*at_ == '"') {
            const void* close = std::memchr(at_ + 1, '"', static_cast<size_t>(end_ - at_ - 1));
            if (!close) fail(at_, "found quotes that nothing closes; expected '\"'");
            at_ = static_cast<const char*>(close) + 1;
            after_comma = false;
        } else if (*at_ == '\0') {
            fail(at_, "found a byte 0; expected text");
        } else {  // a new line, or a comment that reaches up to it
            const char* next = fbx_import::skip_space(at_, end_);
            if (!after_comma && (next == end_ || *next != ',')) return;
            at_ = next;
            crossed_line = true;
        }
    }
}

bool read_number(const char*& at, const char* end, double& number) {
    const char* from = at < end && *at == '+' ? at + 1 : at;
    const std::from_chars_result result = std::from_chars(from, end, number);
    if (result.ptr == from) return false;
    at = result.ptr;
    if (result.ec == std::errc::result_out_of_range) number = *from == '-' ? -HUGE_VAL : HUGE_VAL;
    if (at < end && *at == '#') {  // "1.#INF", as Microsoft's library writes it
        while (at < end && class_of(*at) == other) ++at;
        number = std::numeric_limits<double>::quiet_NaN();
    }
    return true;
}

bool read_number(const char*& at, const char* end, int64_t& number) {
    const char* from = at < end && *at == '+' ? at + 1 : at;
    const std::from_chars_result result = std::from_chars(from, end, number);
    if (result.ec != std::errc() || (result.ptr < end && (*result.ptr == '.' || *result.ptr == 'e' || *result.ptr == 'E'))) {
        return false;
    }
    at = result.ptr;
    return true;
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
        read_number(at, end, value.whole);
    } else if (read_number(at, end, value.whole)) {
        value.kind = Value::integer;
        value.number = static_cast<double>(value.whole);
    } else if (read_number(at, end, value.number)) {
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

std::string without_entities(std::string_view text) {
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        const auto starts = [&](std::string_view entity) { return text.substr(i, entity.size()) == entity; };
        const char c = starts("&quot;") ? '"' : starts("&lf;") ? '\n' : starts("&cr;") ? '\r' : starts("&amp;") ? '&' : text[i];
        out += c;
        if (text[i] == '&' && (c != '&' || starts("&amp;"))) i = text.find(';', i);
    }
    return out;
}

}  // namespace fbx_import
