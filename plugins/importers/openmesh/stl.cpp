// stl.cpp -- reads STL, ASCII and binary.
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// A binary file: 80 bytes of free text, the number of facets as a 32-bit little-endian integer, then 50 bytes per facet.
constexpr size_t kHeaderBytes = 84, kFacetBytes = 50;

uint32_t declared_count(std::string_view bytes) {
    unsigned char count[4];
    std::memcpy(count, bytes.data() + 80, 4);
    return count[0] | count[1] << 8 | count[2] << 16 | uint32_t(count[3]) << 24;
}

bool has(std::string_view text, const char* lower, const char* upper) {
    return text.find(lower) != text.npos || text.find(upper) != text.npos;
}

// A binary file may start with "solid" too. So the file is ASCII only if it has the words that ASCII needs, and not the exact
// size of a binary file.
bool is_ascii(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, 4096);
    if (bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + kFacetBytes * size_t(declared_count(bytes)))
        return false;
    if (head.find('\0') != head.npos) return false;
    return has(head, "solid", "SOLID") || has(head, "facet", "FACET");
}

void read_binary(const Source& source, FlatImporter& mesh) {
    if (source.bytes.size() < kHeaderBytes)
        throw std::runtime_error("byte 0: found " + quoted(source.bytes.substr(0, 16)) +
                                 ", expected 'solid' of a text STL file, or the 84 bytes with which a binary one begins");
    const uint32_t count = declared_count(source.bytes);
    const size_t room = (source.bytes.size() - kHeaderBytes) / kFacetBytes;
    if (count > room) {
        throw std::runtime_error("byte 80: declares " + std::to_string(count) + " facets and has room for " +
                                 std::to_string(room) + ": it is cut off, or no STL file");
    }
    BytesBuffer buffer({}, source.bytes, source.progress);
    run_reader("stl", buffer, true, true, false, mesh);
    if (count > mesh.face_count()) {
        warn(source, counted(count - mesh.face_count(), "facet") + " left out: fewer than three different corners");
    }
}

void read_ascii(const Source& source, FlatImporter& mesh) {
    uint64_t facets = 0, vertices = 0;
    size_t line_number = 0, bad_line = 0;  // the first line behind a facet that has not three vertices
    const auto edit = [&](std::string_view line, int, std::string& out) {
        ++line_number;
        line = trim(line);
        out = line;
        if (has(line, "outer", "OUTER")) {
            if (vertices != 3 * facets && bad_line == 0) bad_line = line_number;
            ++facets;
        }
        const std::string_view word = next_word(line);
        if (word != "vertex" && word != "VERTEX") return !word.empty();
        ++vertices;
        for (int k = 0; k < 3; ++k) {
            float x;
            const std::string_view number = next_word(line);
            if (!parse_float(number, x)) {
                throw std::runtime_error("line " + std::to_string(line_number) + ": " + quoted(number) +
                                         " instead of a coordinate");
            }
        }
        return true;
    };
    LineBuffer buffer(source.bytes, false, edit, 1, source.progress);
    run_reader("stl", buffer, false, false, false, mesh);
    if (vertices != 3 * facets) {
        throw std::runtime_error("line " + std::to_string(bad_line ? bad_line : line_number) + ": found " +
                                 std::to_string(vertices) + " vertices in a file of " + std::to_string(facets) +
                                 " facets, expected three for each up to here: it is cut off or damaged");
    }
    if (facets > mesh.face_count()) {
        warn(source, counted(facets - mesh.face_count(), "facet") + " left out: fewer than three different corners");
    }
}

}  // namespace

void read_stl(const Source& source, FlatImporter& mesh) {
    is_ascii(source.bytes) ? read_ascii(source, mesh) : read_binary(source, mesh);
}

}  // namespace openmesh_import
