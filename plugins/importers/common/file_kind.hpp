// file_kind.hpp -- names the kind of a file by its first bytes. For importers that are given another kind by mistake.
#pragma once
#include <string_view>
#include <utility>

namespace importers {

// The kind, and what to do with such a file; nullptr: it is not known here.
inline const char* kind_of(std::string_view bytes) {
    constexpr std::pair<std::string_view, const char*> kinds[] = {
        {"\x89PNG", "a PNG picture: call it .png"},
        {"\xFF\xD8\xFF", "a JPEG picture: call it .jpg"},
        {"\xFF\xFE", "text in UTF-16: save it as UTF-8"},
        {"\xFE\xFF", "text in UTF-16: save it as UTF-8"},
        {"PK\x03\x04", "a zip archive: unpack it"},
        {"\x1F\x8B", "a gzip archive: unpack it"},
        {"%PDF", "a PDF document: call it .pdf"},
        {"glTF", "a binary glTF file: call it .glb"},
        {"Kaydara FBX", "an FBX file: call it .fbx"},
        {"ply\n", "a PLY file: call it .ply"},
        {"ply\r", "a PLY file: call it .ply"},
        {"<?xml", "an XML file: give it the extension of its format, such as .dae"},
        {"BLENDER", "a Blender file: export it in another format, such as .glb"},
    };
    for (const auto& [magic, kind] : kinds) {
        if (bytes.substr(0, magic.size()) == magic) return kind;
    }
    return nullptr;
}

}  // namespace importers
