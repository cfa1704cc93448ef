#include "document.hpp"

#include "../common/file_kind.hpp"

namespace gltf_import {
namespace {

constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;  // "JSON", "BIN\0"

uint32_t read_u32(std::string_view bytes, size_t at) {
    const auto byte = [&](size_t i) { return uint32_t(static_cast<unsigned char>(bytes[at + i])); };
    return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

[[noreturn]] void refuse(size_t byte, const std::string& found, const std::string& expected) {
    throw Error("byte " + std::to_string(byte) + ": found " + found + ", expected " + expected);
}

// The required extensions that this importer obeys. Those of materials and textures are not listed: without them only the
// surface looks different.
bool is_known(const std::string& name) {
    for (const char* known :
         {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_mesh_quantization",
          "KHR_lights_punctual", "KHR_texture_transform", "KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif",
          "MSFT_texture_dds", "EXT_mesh_gpu_instancing", "KHR_xmp_json_ld"}) {
        if (name == known) return true;
    }
    return name.compare(0, 14, "KHR_materials_") == 0 || name.compare(0, 3, "VRM") == 0;
}

}  // namespace

Document::Document(const rt_host* host, const std::string& path)
    : file_(std::make_unique<importers::MappedFile>(host, path)), folder_(path.substr(0, path.find_last_of('/') + 1)) {
    parse(file_->bytes());
}

Document::Document(std::string_view bytes, std::string folder) : folder_(std::move(folder)) {
    parse(bytes);
}

void Document::parse(std::string_view bytes) {
    if (bytes.empty()) throw Error("the file is empty");
    const char* kind = importers::kind_of(bytes);
    if (kind && bytes.substr(0, 4) != "glTF") refuse(0, kind, "a glTF file (.gltf or .glb)");
    bytes.substr(0, 4) == "glTF" ? parse_chunks(bytes) : parse_json(bytes, 0);
    check_version();
}

void Document::parse_chunks(std::string_view bytes) {
    const std::string size = std::to_string(bytes.size());
    if (bytes.size() < kHeaderBytes + kChunkHeaderBytes)
        refuse(bytes.size(), "the end of the file", "a header of 12 bytes and one of a chunk of 8 bytes");
    if (const uint32_t version = read_u32(bytes, 4); version != 2)
        refuse(4, "version " + std::to_string(version) + " of binary glTF", "version 2: export it again as glTF 2.0");
    const uint32_t declared = read_u32(bytes, 8);
    if (declared > bytes.size())
        refuse(8, "a length of " + std::to_string(declared) + " bytes in a file of " + size,
               "the file's size: it is cut off or damaged");
    if (declared < bytes.size()) bytes = bytes.substr(0, declared);
    size_t number = 0;
    for (size_t at = kHeaderBytes; at + kChunkHeaderBytes <= bytes.size(); ++number) {
        const uint32_t length = read_u32(bytes, at), type = read_u32(bytes, at + 4);
        const size_t left = bytes.size() - at - kChunkHeaderBytes;
        if (length > left)
            refuse(at, "a chunk of " + std::to_string(length) + " bytes",
                   "at most " + std::to_string(left) + ", which the file has left");
        const std::string_view content = bytes.substr(at + kChunkHeaderBytes, length);
        if (number == 0 && type != kJsonChunk)
            refuse(at + 4, "a chunk of type " + in_quotes(bytes.substr(at + 4, 4)), "'JSON' as the first chunk");
        if (number == 0) parse_json(content, at + kChunkHeaderBytes);
        if (number == 1 && type == kBinaryChunk) {
            has_binary_ = true;
            binary_ = content;
        }
        at += kChunkHeaderBytes + length;
    }
    if (number == 0) refuse(8, "a length of " + std::to_string(declared), "at least 20");
}

void Document::parse_json(std::string_view text, size_t first_byte) {
    while (!text.empty() && text.back() == '\0') text.remove_suffix(1);  // some programs fill chunks up with zeros
    check_json(text, first_byte);
    json_ = nlohmann::json::parse(text.begin(), text.end());
}

void Document::check_version() const {
    const Value asset = root()["asset"], version = asset["version"];
    if (version.text().compare(0, 2, "2.") != 0) version.refuse("'2.0': export it again as glTF 2.0");
    if (asset.text("minVersion", "2.0") != "2.0") asset["minVersion"].refuse("'2.0', which this importer reads");
    const Value required = list("extensionsRequired");
    for (size_t i = 0; i < required.size(); ++i) {
        if (!is_known(required[i].text()))
            required[i].refuse("no extension that this importer does not read: export the file again without it");
    }
}

}  // namespace gltf_import
