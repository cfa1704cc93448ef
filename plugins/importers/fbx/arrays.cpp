// arrays.cpp -- the arrays of a document: plain, deflated or as text.
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "../common/base64.hpp"
#include "ascii.hpp"
#include "binary.hpp"

namespace fbx_import {
namespace {

template <class T, class From>
T converted(From value) {
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else if constexpr (std::is_floating_point_v<From>) {
        if (!(value == value)) return 0;
        if (value >= static_cast<From>(std::numeric_limits<T>::max())) return std::numeric_limits<T>::max();
        if (value <= static_cast<From>(std::numeric_limits<T>::min())) return std::numeric_limits<T>::min();
        return static_cast<T>(value);
    } else {
        return static_cast<T>(std::clamp<int64_t>(value, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
    }
}

template <class T, class From>
void convert(const char* from, size_t count, bool big_endian, T* to) {
    if (std::is_same_v<T, From> && !big_endian) {
        std::memcpy(to, from, count * sizeof(T));
    } else if (!big_endian) {
        for (size_t i = 0; i < count; ++i) to[i] = converted<T>(load<From>(from + i * sizeof(From), false));
    } else {
        for (size_t i = 0; i < count; ++i) to[i] = converted<T>(load<From>(from + i * sizeof(From), true));
    }
}

template <class T>
void convert(char type, const char* from, size_t count, bool big_endian, T* to) {
    switch (type) {
        case 'd':
            return convert<T, double>(from, count, big_endian, to);
        case 'f':
            return convert<T, float>(from, count, big_endian, to);
        case 'l':
            return convert<T, int64_t>(from, count, big_endian, to);
        case 'i':
            return convert<T, int32_t>(from, count, big_endian, to);
        default:
            return convert<T, int8_t>(from, count, big_endian, to);
    }
}

struct Inflater {
    z_stream stream{};
    bool good = inflateInit(&stream) == Z_OK;
    ~Inflater() { inflateEnd(&stream); }
};

// Inflates piece by piece, so that no more than `count` elements are ever written, and the plain bytes are not all held.
template <class T>
void inflate_array(char type, std::string_view deflated, bool big_endian, std::vector<T>& out, const std::string& where) {
    Inflater inflater;
    z_stream& s = inflater.stream;
    s.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(deflated.data()));
    s.avail_in = static_cast<uInt>(deflated.size());
    const size_t element = element_bytes(type), most = 32768 / element;
    std::vector<char> piece(32768);
    for (size_t done = 0; done < out.size();) {
        const size_t count = std::min(most, out.size() - done);
        s.next_out = reinterpret_cast<Bytef*>(piece.data());
        s.avail_out = static_cast<uInt>(count * element);
        int state = inflater.good ? Z_OK : Z_MEM_ERROR;
        while (state == Z_OK && s.avail_out > 0) state = inflate(&s, Z_NO_FLUSH);
        if (s.avail_out > 0) {
            throw Broken(where + ": its deflated bytes end or are damaged after " +
                         std::to_string(done + (count * element - s.avail_out) / element) + " of " +
                         std::to_string(out.size()) + " values; expected all of them");
        }
        convert(type, piece.data(), count, big_endian, out.data() + done);
        done += count;
    }
    char more;
    s.next_out = reinterpret_cast<Bytef*>(&more);
    s.avail_out = 1;
    if (!out.empty() && inflate(&s, Z_NO_FLUSH) != Z_STREAM_END && s.avail_out == 0) {
        throw Broken(where + ": its deflated bytes hold more than the " + std::to_string(out.size()) +
                     " values that it declares");
    }
}

// Deflated bytes become 1032 times as many at most. Source: zlib's technical details, "Maximum Compression Factor".
constexpr uint64_t kMostInflation = 1032;

template <class T>
std::vector<T> binary_array(const Value& value, bool big_endian, const std::string& where) {
    const size_t element = element_bytes(value.type);
    const uint64_t count = load<uint32_t>(value.text.data(), big_endian);
    const uint32_t encoding = load<uint32_t>(value.text.data() + 4, big_endian);
    const std::string_view bytes = value.text.substr(12);
    const auto fail = [&](const std::string& what) { throw Broken(where + ": " + what); };
    if (encoding > 1) fail("has the encoding " + std::to_string(encoding) + "; expected 0 (plain) or 1 (deflated)");
    if (encoding == 0 ? count * element != bytes.size() : count * element > kMostInflation * bytes.size()) {
        fail("declares " + std::to_string(count) + " values of " + std::to_string(element) + " bytes, but has " +
             std::to_string(bytes.size()) + (encoding ? " deflated" : "") + " bytes");
    }
    std::vector<T> out(count);
    if (encoding == 0) {
        convert(value.type, bytes.data(), count, big_endian, out.data());
    } else {
        inflate_array(value.type, bytes, big_endian, out, where);
    }
    return out;
}

template <class T>
std::vector<T> text_array(const Document& document, const Node& node, size_t expected) {
    std::vector<T> out;
    const char *at = node.values.data(), *const end = at + node.values.size();
    out.reserve(std::min(expected ? expected : node.values.size() / 4, node.values.size() / 2 + 1));
    while (true) {
        while (at < end && (*at == ' ' || *at == ',' || *at == '\n' || *at == '\r' || *at == '\t')) ++at;
        if (at == end) return out;
        if (*at == ';') {
            while (at < end && *at != '\n') ++at;
            continue;
        }
        int64_t whole = 0;
        double number = 0;
        if (!std::is_floating_point_v<T> && read_number(at, end, whole)) {
            out.push_back(converted<T>(whole));
        } else if (read_number(at, end, number)) {
            out.push_back(converted<T>(number));
        } else if (at[0] != '*') {
            throw Broken(document.place(at) + ": found " + quoted({at, static_cast<size_t>(end - at)}) +
                         " among the values of " + quoted(node.name) + "; expected a number");
        } else {
            return out;  // an array whose numbers are missing
        }
    }
}

}  // namespace

template <class T>
std::vector<T> Document::numbers(const Node* node) const {
    if (!node) return {};
    const Value first = value(*node, 0);
    if (!binary_) {
        const Node* inner = first.kind == Value::array ? child(node, "a") : nullptr;
        if (!inner) return text_array<T>(*this, *node, 0);
        const size_t declared = static_cast<size_t>(std::clamp<int64_t>(first.whole, 0, int64_t(1) << 40));
        std::vector<T> out = text_array<T>(*this, *inner, declared);
        if (out.size() < declared) {
            throw Broken(place(*node) + ": " + quoted(node->name) + " declares " + std::to_string(declared) +
                         " values, but has " + std::to_string(out.size()));
        }
        out.resize(declared);
        return out;
    }
    if (first.kind == Value::array) return binary_array<T>(first, big_endian_, place(*node) + ": " + quoted(node->name));
    // Before version 7, each number is a value of its own (measured from maya_cube_6100_binary).
    std::vector<T> out;
    out.reserve(node->value_count);
    Values values(*this, *node);
    for (Value v; values.next(v);) {
        if (v.kind != Value::integer && v.kind != Value::real) {
            throw Broken(place(*node) + ": value " + std::to_string(out.size()) + " of " + quoted(node->name) +
                         " is no number; expected one");
        }
        out.push_back(v.kind == Value::integer ? converted<T>(v.whole) : converted<T>(v.number));
    }
    return out;
}

template std::vector<float> Document::numbers<float>(const Node*) const;
template std::vector<double> Document::numbers<double>(const Node*) const;
template std::vector<int32_t> Document::numbers<int32_t>(const Node*) const;
template std::vector<int64_t> Document::numbers<int64_t>(const Node*) const;

uint64_t Document::count(const Node& node) const {
    const Value first = value(node, 0);
    if (first.kind != Value::array) return binary_ ? node.value_count : node.values.size() / 2;
    return binary_ ? load<uint32_t>(first.text.data(), big_endian_) : static_cast<uint64_t>(std::max<int64_t>(first.whole, 0));
}

std::string Document::content(const Node& node) const {
    std::string out;
    Values values(*this, node);
    for (Value v; values.next(v);) {
        if (v.kind != Value::string && v.kind != Value::raw) continue;
        if (binary_) {
            out += v.text;
        } else {
            std::string digits(v.text);
            digits.erase(std::remove_if(digits.begin(), digits.end(), [](char c) { return c <= ' '; }), digits.end());
            importers::decode_base64(digits, out);
        }
    }
    return out;
}

}  // namespace fbx_import
