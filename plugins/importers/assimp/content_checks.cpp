#include "content_checks.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "xml_tags.hpp"

namespace assimp_import {
namespace {

size_t words_in(std::string_view text) {
    size_t count = 0;
    for (size_t at = 0; (at = text.find_first_not_of(kXmlBlanks, at)) != text.npos; ++count) {
        at = std::min(text.find_first_of(kXmlBlanks, at), text.size());
    }
    return count;
}

int64_t whole(std::string_view text, int64_t otherwise) {
    std::from_chars(text.data(), text.data() + text.size(), otherwise);
    return otherwise;
}

class Scan {
 public:
    explicit Scan(std::string_view text) : text_(text) {}

    std::string run() {
        for (XmlTags tags(text_); why_.empty() && tags.next();) {
            if (open_array_) open_array_->found += static_cast<int64_t>(words_in(tags.before));
            if (tags.is_tag) tag(tags);
        }
        for (const Accessor& accessor : accessors_) check(accessor);
        return why_;
    }

 private:
    struct Array {
        int64_t declared = 0, found = 0;  // numbers
    };
    struct Accessor {
        std::string_view tag;
        int64_t parameters = 0;
    };

    void tag(const XmlTags& found) {
        const std::string_view tag = found.tag, name = found.name;
        open_array_ = nullptr;
        if (found.ends) {
            depth_ -= depth_ > 0;
            in_accessor_ = in_accessor_ && name != "accessor";
            return;
        }
        if (!found.is_empty && ++depth_ > kMostLevels) fail(tag, "another level", "at most 1000 elements inside each other");
        if (name == "accessor") accessors_.push_back({tag, 0});
        if (name == "param" && in_accessor_) ++accessors_.back().parameters;
        if (name == "accessor") in_accessor_ = !found.is_empty;
        if (name.size() < 7 || name.substr(name.size() - 6) != "_array") return;
        const std::string_view count = xml_attribute(tag, "count");
        if (count.empty()) fail(tag, "<" + std::string(name) + "> without 'count'", "that attribute");
        open_array_ = &(arrays_[xml_attribute(tag, "id")] = {whole(count, 0), 0});
    }

    void check(const Accessor& accessor) {
        const std::string_view source = xml_attribute(accessor.tag, "source");
        const auto array = arrays_.find(source.substr(std::min<size_t>(1, source.size())));
        const auto number = [&](const char* name, int64_t otherwise) {
            return whole(xml_attribute(accessor.tag, name), otherwise);
        };
        const int64_t count = number("count", 0), stride = number("stride", 1), offset = number("offset", 0);
        if (array == arrays_.end() || count <= 0) return;
        const int64_t room = std::min(array->second.declared, array->second.found);
        const double last = double(offset) + double(stride) * double(count - 1) + double(accessor.parameters);
        if (offset >= 0 && stride >= 0 && last <= double(room)) return;
        fail(accessor.tag,
             "an <accessor> to " + std::to_string(count) + " elements of " + std::to_string(stride) +
                 " numbers from the number " + std::to_string(offset) + " on",
             "elements within the " + std::to_string(room) + " numbers of " + in_quotes(source));
    }

    // tag: the one that is wrong. Its name is the place. Only the first place counts.
    void fail(std::string_view tag, const std::string& found, const std::string& expected) {
        const std::string_view before = text_.substr(0, static_cast<size_t>(tag.data() - text_.data()) + 1);
        if (!why_.empty()) return;
        why_ = "line " + std::to_string(std::count(before.begin(), before.end(), '\n') + 1) + ", column " +
               std::to_string(before.size() - before.rfind('\n')) +  // npos is -1
               ": found " + found + ", expected " + expected;
    }

    static constexpr size_t kMostLevels = 1000;
    const std::string_view text_;
    std::map<std::string_view, Array> arrays_;  // by id
    std::vector<Accessor> accessors_;
    Array* open_array_ = nullptr;  // the one whose numbers follow
    bool in_accessor_ = false;
    size_t depth_ = 0;
    std::string why_;
};

// Returns an empty string, or the place, what is there and what should be. It finds accessors of COLLADA that reach beyond
// their array, and elements inside each other that assimp follows by recursion. Everything else that is wrong assimp refuses
// itself.
std::string crash_in_xml(std::string_view text) {
    const bool is_utf16 = text.substr(0, 2) == "\xFE\xFF" || text.substr(0, 2) == "\xFF\xFE";
    return is_utf16 ? std::string() : Scan(text).run();
}

uint32_t read_le(std::string_view bytes, size_t at, size_t size) {
    uint32_t value = 0;
    for (size_t i = 0; i < size; ++i) value |= uint32_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
    return value;
}

std::string place(size_t byte, const std::string& found, const std::string& expected) {
    return "byte " + std::to_string(byte) + ": found " + found + ", expected " + expected;
}

std::string hex(uint32_t value) {
    std::string out = "0x";
    for (int shift = 12; shift >= 0; shift -= 4) out += "0123456789ABCDEF"[value >> shift & 15];
    return out;
}

// A chunk of 3DS: its kind in 2 bytes, its length in 4, which counts these 6. Some hold other chunks, an object after its name.
std::string damage_in_3ds(std::string_view bytes) {
    constexpr size_t kHead = 6;
    constexpr uint32_t kMain = 0x4D4D, kEditor = 0x3D3D, kObject = 0x4000, kMesh = 0x4100, kVertices = 0x4110, kFaces = 0x4120;
    if (bytes.size() < kHead) return place(bytes.size(), "the end of the file", "the 6 bytes with which a chunk begins");
    if (read_le(bytes, 0, 2) != kMain) return place(0, in_quotes(bytes.substr(0, 2)), "'MM', with which a 3DS file begins");
    struct Range {
        size_t first, end;
    };
    std::vector<Range> open = {{0, bytes.size()}};
    while (!open.empty()) {
        const Range in = open.back();
        open.pop_back();
        for (size_t at = in.first; at + kHead <= in.end;) {
            const uint32_t kind = read_le(bytes, at, 2), length = read_le(bytes, at + 2, 4);
            const std::string what = "a chunk " + hex(kind) + " of " + std::to_string(length) + " bytes";
            if (length < kHead) return place(at, what, "6 bytes or more");
            if (length > in.end - at) return place(at, what, "at most " + std::to_string(in.end - at) + ", which are left");
            size_t first = at + kHead;
            const size_t end = at + length;
            if (kind == kObject) {
                while (first < end && bytes[first] != '\0') ++first;
                if (first == end) return place(at + kHead, "the name of an object without an end", "a byte 0 behind it");
                ++first;
            }
            if (kind == kVertices || kind == kFaces) {
                const size_t each = kind == kVertices ? 12 : 8, room = end - first;
                const uint32_t count = room < 2 ? 0 : read_le(bytes, first, 2);
                if (room < 2 || count * each > room - 2)
                    return place(
                        first, std::to_string(count) + (kind == kVertices ? " vertices" : " faces"),
                        "at most " + std::to_string(room < 2 ? 0 : (room - 2) / each) + ", for which the chunk has room");
            }
            if (kind == kMain || kind == kEditor || kind == kObject || kind == kMesh) open.push_back({first, end});
            if (in.first == 0 && in.end == bytes.size()) break;  // some programs write more behind the main chunk
            at = end;
        }
    }
    return {};
}

bool is_xml(const std::string& extension) {
    for (const char* known : {"dae", "x3d", "xgl", "irr", "irrmesh", "amf"}) {
        if (extension == known) return true;
    }
    return false;
}

// The bytes with which files of a format begin.
std::string_view magic_of(const std::string& extension) {
    constexpr std::pair<const char*, std::string_view> kinds[] = {
        {"ms3d", "MS3D000000"},   {"md2", "IDP2"},      {"md3", "IDP3"},         {"lwo", "FORM"},
        {"lxo", "FORM"},          {"b3d", "BB3D"},      {"ter", "TERRAGEN"},     {"x", "xof "},
        {"ac", "AC3D"},           {"ase", "*3DSMAX"},   {"ifc", "ISO-10303-21"}, {"3mf", "PK"},
        {"q3o", "quick3D"},       {"cob", "Caligari "}, {"bvh", "HIERARCHY"},    {"lws", "LWSC"},
        {"md5mesh", "MD5Version"}};
    for (const auto& [known, magic] : kinds) {
        if (extension == known) return magic;
    }
    return {};
}

bool has(const std::string& text, const char* words) {
    return text.find(words) != text.npos;
}

}  // namespace

std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 60 ? "...'" : "'");
}

std::string damage_in(std::string_view bytes, const std::string& extension) {
    if (is_xml(extension)) return crash_in_xml(bytes);
    return extension == "3ds" ? damage_in_3ds(bytes) : std::string();
}

std::string explain_refusal(std::string_view bytes, const std::string& extension, const std::string& message) {
    const std::string_view magic = magic_of(extension);
    if (!magic.empty() && !bytes.empty() && bytes.substr(0, magic.size()) != magic)
        return place(0, in_quotes(bytes.substr(0, std::max<size_t>(magic.size(), 4))),
                     in_quotes(magic) + ", with which a ." + extension + " file begins");
    if (message.empty() || has(message, "No suitable reader") || has(message, "nknown error"))
        return place(0, in_quotes(bytes.substr(0, 16)),
                     "the content of a ." + extension + " file: it is damaged, or of another format");
    // Words of the C++ library: a number in the file was taken for the size of something.
    if (has(message, "std::") || has(message, "vector::") || has(message, "basic_string") || has(message, "bad_") ||
        has(message, "_M_"))
        return "found a number that counts more than the file can hold, expected the size of something in it: it is damaged "
               "(assimp "
               "does not say where)";
    std::string clean;
    for (const char c : message) clean += c >= ' ' && c <= '~' ? c : c == '\n' ? ' ' : '?';
    return "assimp cannot read it: " + clean.substr(0, 300);
}

}  // namespace assimp_import
