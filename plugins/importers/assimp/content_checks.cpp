#include "content_checks.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "collada_check.hpp"

namespace assimp_import {
namespace {

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
