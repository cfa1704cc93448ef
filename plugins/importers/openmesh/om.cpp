// om.cpp -- reads OM, OpenMesh's own binary format.
#include <cstring>
#include <stdexcept>

#include "readers.hpp"

namespace openmesh_import {

// The header: "OM", 'T' | 'Q' | 'P', version, then the numbers of vertices, faces and edges as 32-bit little-endian integers.
void read_om(const Source& source, FlatImporter& mesh) {
    constexpr size_t header_bytes = 16;
    if (source.bytes.size() < header_bytes || source.bytes.substr(0, 2) != "OM" || !std::strchr("TQP", source.bytes[2])) {
        throw std::runtime_error("byte 0: not an OM file: its header, 'OM' and the kind of its faces, is not there");
    }
    uint32_t counts[3];
    for (int i = 0; i < 3; ++i) {
        unsigned char b[4];
        std::memcpy(b, source.bytes.data() + 4 + 4 * i, 4);
        counts[i] = b[0] | b[1] << 8 | b[2] << 16 | uint32_t(b[3]) << 24;
    }
    const char* const names[3] = {"vertex", "face", "edge"};
    const unsigned least[3] = {12, 1, 1};
    for (int i = 0; i < 3; ++i) {
        const std::string why = too_large(names[i], counts[i], least[i], source.bytes.size() - header_bytes);
        if (!why.empty()) throw std::runtime_error(why);
    }
    mesh.properties.vertices = counts[0];
    mesh.properties.faces = counts[1];
    mesh.properties.edges = counts[2];
    BytesBuffer buffer({}, source.bytes, source.progress);
    bool whole = false;
    try {
        whole = run_reader("om", buffer, true, false, false, mesh);
    } catch (const std::ios_base::failure&) {
        // Files before version 2 have no end mark, and are read until no data is left.
    }
    if (mesh.n_vertices() != counts[0] || mesh.n_faces() != counts[1] || (counts[1] > 0 && mesh.n_faces() == 0)) {
        throw std::runtime_error("has " + std::to_string(mesh.n_vertices()) + " of " + std::to_string(counts[0]) +
                                 " vertices and " + std::to_string(mesh.n_faces()) + " of " + std::to_string(counts[1]) +
                                 " faces: it is cut off, damaged, or of a newer version");
    }
    if (!whole) warn(source, "the file ends early; vertices and faces are complete");
}

}  // namespace openmesh_import
