// arrays.cpp -- the arrays of a document: plain, deflated or as text.
#include <algorithm>

#include "../common/base64.hpp"
#include "../common/inflate.hpp"
#include "../common/text_lines.hpp"
#include "binary.hpp"

namespace fbx_import {
namespace {

using importers::nearest;

template <class T, class From>
void convert(const char* from, size_t count, bool big_endian, T* to) {
    if (count == 0) return;  // no memory, then, that memcpy could be told of
    if (std::is_same_v<T, From> && !big_endian) {
        std::memcpy(to, from, count * sizeof(T));
    } else if (!big_endian) {  // a loop of its own is faster
        for (size_t i = 0; i < count; ++i) to[i] = nearest<T>(load<From>(from + i * sizeof(From), false));
    } else {
        for (size_t i = 0; i < count; ++i) to[i] = nearest<T>(load<From>(from + i * sizeof(From), true));
    }
}

template <class T>
void convert(char type, const char* from, size_t count, bool big_endian, T* to) {
    if (type == 'd') return convert<T, double>(from, count, big_endian, to);
    if (type == 'f') return convert<T, float>(from, count, big_endian, to);
    if (type == 'l') return convert<T, int64_t>(from, count, big_endian, to);
    if (type == 'i') return convert<T, int32_t>(from, count, big_endian, to);
    convert<T, int8_t>(from, count, big_endian, to);
}

}  // namespace

// Its numbers are inflated piece by piece, so that no more than it declares are ever written.
template <class T>
std::vector<T> Document::binary_array(const Node& node, const Value& array) const {
    const size_t element = element_bytes(array.type);
    const uint64_t count = load<uint32_t>(array.text.data(), big_endian_);
    const uint32_t encoding = load<uint32_t>(array.text.data() + 4, big_endian_);
    const std::string_view bytes = array.text.substr(12);
    const auto refuse = [&](const std::string& what) { fail(node, quoted(node.name) + ": " + what); };
    if (encoding > 1) refuse("has the encoding " + std::to_string(encoding) + "; expected 0 (plain) or 1 (deflated)");
    const uint64_t most = bytes.size() * (encoding == 0 ? 1 : importers::kMostInflation);
    if (count * element > most || (encoding == 0 && count * element != most)) {
        refuse("declares " + std::to_string(count) + " values of " + std::to_string(element) + " bytes, but has " +
               std::to_string(bytes.size()) + (encoding ? " deflated" : "") + " bytes");
    }
    std::vector<T> out(count);
    if (encoding == 0) convert(array.type, bytes.data(), count, big_endian_, out.data());
    if (encoding == 0 || count == 0) return out;
    importers::Inflater inflater(bytes);
    std::vector<char> piece(32768);
    for (size_t done = 0; done < count;) {
        const size_t wanted = std::min<size_t>(piece.size() / element, count - done);
        const size_t found = inflater.read(piece.data(), wanted * element) / element;
        if (found < wanted) {
            refuse("its deflated bytes end or are damaged after " + std::to_string(done + found) + " of " +
                   std::to_string(count) + " values; expected all of them");
        }
        convert(array.type, piece.data(), wanted, big_endian_, &out[done]);
        done += wanted;
    }
    if (inflater.read(piece.data(), 1) > 0)
        refuse("its deflated bytes hold more than the " + std::to_string(count) + " values that it declares");
    return out;
}

// declared: how many numbers there should be; 0: unknown.
template <class T>
std::vector<T> Document::text_array(const Node& node, size_t declared) const {
    std::vector<T> out;
    const char *at = node.values.data(), *const end = at + node.values.size();
    out.reserve(std::min(declared ? declared : node.values.size() / 4, node.values.size() / 2 + 1));
    while (true) {
        while (at < end && (*at == ' ' || *at == ',' || *at == '\t' || importers::is_line_end(*at))) ++at;
        if (at == end) return out;
        if (*at == ';') {
            at = std::find_if(at, end, importers::is_line_end);
            continue;
        }
        int64_t whole = 0;
        double number = 0;
        if (!std::is_floating_point_v<T> && importers::read_number(at, end, whole)) {
            out.push_back(nearest<T>(whole));
        } else if (importers::read_number(at, end, number)) {
            out.push_back(nearest<T>(number));
        } else if (*at == '*') {
            return out;  // an array whose numbers are missing
        } else {
            fail(at, "found " + quoted({at, static_cast<size_t>(end - at)}) + " among the values of " + quoted(node.name) +
                         "; expected a number");
        }
    }
}

template <class T>
std::vector<T> Document::numbers(const Node* node) const {
    if (!node) return {};
    const Value first = value(*node, 0);
    if (!binary_) {
        const Node* inner = first.kind == Value::array ? child(node, "a") : nullptr;
        if (!inner) return text_array<T>(*node, 0);
        const size_t declared = static_cast<size_t>(std::clamp<int64_t>(first.whole, 0, int64_t(1) << 40));
        std::vector<T> out = text_array<T>(*inner, declared);
        if (out.size() < declared) {
            fail(*node, quoted(node->name) + " declares " + std::to_string(declared) + " values, but has " +
                            std::to_string(out.size()));
        }
        return out;
    }
    if (first.kind == Value::array) return binary_array<T>(*node, first);
    // Before version 7, each number is a value of its own (measured from maya_cube_6100_binary).
    std::vector<T> out;
    out.reserve(node->value_count);
    Values values(*this, *node);
    for (Value v; values.next(v);) {
        if (!v.is_number()) {
            fail(*node, "value " + std::to_string(out.size()) + " of " + quoted(node->name) + " is no number; expected one");
        }
        out.push_back(v.kind == Value::integer ? nearest<T>(v.whole) : nearest<T>(v.number));
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
    std::string out, digits;
    const auto decode = [&] {
        importers::decode_base64(digits, out);
        digits.clear();
    };
    Values values(*this, node);
    for (Value v; values.next(v);) {
        if (v.kind != Value::string) continue;
        if (binary_) {
            out += v.text;
            continue;
        }
        std::copy_if(v.text.begin(), v.text.end(), std::back_inserter(digits), [](char c) { return c > ' '; });
        if (!digits.empty() && digits.back() == '=') decode();  // otherwise, the next text goes on within the same byte
    }
    decode();
    return out;
}

}  // namespace fbx_import
