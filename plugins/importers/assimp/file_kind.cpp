#include "file_kind.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>

namespace assimp_import {
namespace {

// A binary FBX file starts with this text, then 0x00, 0x1A, 0 for little-endian or 1 for big-endian, 0, and the version as a
// 32-bit integer.
constexpr std::string_view kFbxMagic = "Kaydara FBX Binary  ";
constexpr size_t kFbxEndianAt = 22, kFbxVersionAt = 23, kFbxHeaderBytes = 27;

std::string_view text_of(const uint8_t* head, size_t bytes) {
    return {reinterpret_cast<const char*>(head), bytes};
}

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

// Returns the text without a byte order mark and leading white space.
std::string_view trimmed(std::string_view text) {
    if (starts_with(text, "\xEF\xBB\xBF")) text.remove_prefix(3);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    return text;
}

bool is_ascii_fbx(std::string_view text) {
    text = trimmed(text);
    const std::string_view line = text.substr(0, text.find('\n'));
    if (starts_with(line, ";") && line.find("FBX") != line.npos) return true;
    return starts_with(text, "FBXHeaderExtension");
}

uint32_t read_u32(const uint8_t* p, bool big_endian) {
    return big_endian ? uint32_t(p[0]) << 24 | uint32_t(p[1]) << 16 | uint32_t(p[2]) << 8 | p[3]
                      : uint32_t(p[3]) << 24 | uint32_t(p[2]) << 16 | uint32_t(p[1]) << 8 | p[0];
}

// Returns what the file really is if its extension is wrong; nullptr: unknown.
const char* other_kind(std::string_view text) {
    struct Kind {
        std::string_view magic;
        const char* name;
    };
    static constexpr Kind kinds[] = {
        {"\x89PNG", "a PNG picture"},   {"\xFF\xD8\xFF", "a JPEG picture"}, {"PK\x03\x04", "a zip archive"},
        {"\x1F\x8B", "a gzip archive"}, {"%PDF", "a PDF document"},         {"glTF", "a binary glTF file"},
        {"ply", "a PLY file"},          {"<?xml", "an XML file"},           {"BLENDER", "a Blender file"},
    };
    for (const Kind& kind : kinds) {
        if (starts_with(text, kind.magic)) return kind.name;
    }
    return nullptr;
}

std::string version_text(int version) {
    return "FBX " + std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 100);
}

}  // namespace

int certainty(const uint8_t* head, size_t bytes) {
    const std::string_view text = text_of(head, bytes);
    if (starts_with(text, kFbxMagic)) return 100;
    if (is_ascii_fbx(text)) return 95;
    if (text.substr(0, 1024).find("<COLLADA") != text.npos) return 90;
    return 0;
}

int fbx_version(const uint8_t* head, size_t bytes) {
    const std::string_view text = text_of(head, bytes);
    if (starts_with(text, kFbxMagic)) {
        if (bytes < kFbxHeaderBytes) return 0;
        return static_cast<int>(std::min(read_u32(head + kFbxVersionAt, head[kFbxEndianAt] == 1), 99999u));
    }
    // Readers obey `FBXVersion: 7400`. Very old files have only the comment `; FBX 7.4.0 project file`.
    int version = 0;
    const auto digit = [&](size_t i) { return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])); };
    if (const size_t key = text.find("FBXVersion:"); key != text.npos) {
        size_t at = text.find_first_not_of(" \t", key + 11);
        for (; digit(at) && version < 10000; ++at) version = version * 10 + (text[at] - '0');
        return version;
    }
    if (const size_t key = text.find("FBX "); key != text.npos && digit(key + 4)) {
        version = (text[key + 4] - '0') * 1000;
        if (key + 6 < text.size() && text[key + 5] == '.' && digit(key + 6)) version += (text[key + 6] - '0') * 100;
    }
    return version;
}

std::string fbx_refusal(const uint8_t* head, size_t bytes) {
    const std::string_view text = text_of(head, bytes);
    if (bytes == 0) return "the file is empty";
    const bool binary = starts_with(text, "Kaydara FBX Binary");
    if (!binary && !is_ascii_fbx(text)) {
        if (const char* kind = other_kind(text)) return std::string("not an FBX file: it is ") + kind + "; rename it";
        if (text.substr(0, 4096).find("FBX") == text.npos)
            return "not an FBX file: neither the binary nor the text header is there";
    }
    if (binary && (bytes < kFbxHeaderBytes || !starts_with(text, kFbxMagic) || head[20] != 0 || head[21] != 0x1A)) {
        return "the header of this binary FBX file is damaged (was it transferred as text?): fetch or export it again";
    }
    if (binary && head[kFbxEndianAt] == 1) {
        return version_text(fbx_version(head, bytes)) +
               " in big-endian byte order; this importer reads little-endian files: open it in a modelling program and export "
               "it "
               "again";
    }
    const int version = fbx_version(head, bytes);
    if (version > 0 && version < 7100) {
        // Up to FBX 5, the header holds the version of the container format, not of FBX.
        return (version < 5800 ? std::string("FBX 5 or older") : version_text(version)) +
               "; this importer reads FBX 7.1 and later: open it in a modelling program or FBX Converter and export it as FBX "
               "2014 "
               "(7.4) or newer";
    }
    return {};
}

}  // namespace assimp_import
