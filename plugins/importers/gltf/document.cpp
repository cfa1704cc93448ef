#include "document.hpp"

#include <algorithm>

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

// "line 3, column 7 (byte 52)", for a character of the JSON text, which begins at `first_byte` of the file.
std::string place(std::string_view text, size_t at, size_t first_byte) {
    const std::string_view before = text.substr(0, at);
    const auto line_first = before.begin() + static_cast<std::ptrdiff_t>(before.rfind('\n') + 1);  // npos + 1 is 0
    const auto column = std::count_if(line_first, before.end(), [](char c) { return (c & 0xC0) != 0x80; });
    return "line " + std::to_string(std::count(before.begin(), before.end(), '\n') + 1) + ", column " +
           std::to_string(column + 1) + " (byte " + std::to_string(first_byte + at) + "): ";
}

// Values are compared, shown and destroyed by recursion. glTF needs about ten levels; `extras` may hold anything. nlohmann's
// callback for the depth takes time that is quadratic in the length of arrays.
void limit_depth(std::string_view text, size_t first_byte) {
    constexpr size_t kMostLevels = 128;
    size_t depth = 0;
    for (size_t at = 0; (at = text.find_first_of("\"[]{}", at)) != text.npos; ++at) {
        if (text[at] == '"') {
            for (++at; at < text.size() && text[at] != '"'; ++at) at += text[at] == '\\';
        } else if (text[at] == ']' || text[at] == '}') {
            depth -= depth > 0;
        } else if (++depth > kMostLevels) {
            throw Error(place(text, at, first_byte) +
                        "found another level, expected at most 128 arrays and objects in each other");
        }
    }
}

// What the parser says behind " - " or behind its own name: "unexpected '}'; expected string literal", "invalid string: missing
// closing quote; last read: '"roo'".
std::string in_our_words(const std::string& message) {
    std::string out;
    const size_t dash = message.find(" - "), name = message.find("] ");
    for (const char c : message.substr(dash != message.npos ? dash + 3 : name != message.npos ? name + 2 : 0))
        out += c >= ' ' && c <= '~' ? c : '?';
    if (out.compare(0, 11, "unexpected ") == 0) out.erase(0, 11);
    size_t expected = out.rfind("; expected ");
    // What was read may hold these words itself: those of the parser follow its closing quote.
    const size_t read = out.find("; last read: '");
    if (expected != out.npos && expected > read && out[expected - 1] != '\'') expected = out.npos;
    const std::string rest = expected == out.npos ? ", expected JSON" : ", " + out.substr(expected + 2);
    out.resize(std::min(expected, out.size()));
    if (out.size() > 120) out = out.substr(0, 120) + (out.back() == '\'' ? "...'" : "...");  // what was read ends with a quote
    return "found " + out + rest.substr(0, 120);
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
    limit_depth(text, first_byte);
    try {
        json_ = nlohmann::json::parse(text.begin(), text.end());
    } catch (const nlohmann::json::parse_error& error) {
        throw Error(place(text, std::min(error.byte - std::min<size_t>(error.byte, 1), text.size()), first_byte) +
                    in_our_words(error.what()));
    } catch (const nlohmann::json::out_of_range& error) {  // "number overflow parsing '1e999'"
        const std::string message = error.what();
        const size_t quote = message.find('\'') + 1;
        const std::string number = message.substr(quote, message.rfind('\'') - quote);
        throw Error(place(text, text.find(number), first_byte) + "found " + in_quotes(number) +
                    ", expected a number that a computer can hold");
    }
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
