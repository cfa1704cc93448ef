// off.cpp -- reads OFF, text. Sources: Geomview's manual, "OFF Files"; files of CGAL and MeshLab.
#include <stdexcept>
#include <string>

#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// The header word, [ST][C][N]OFF. Of the data behind a vertex's position, only normals are kept.
struct OffKind {
    bool has_normals = false, has_colors = false, is_four_dimensional = false;
};

bool parse_kind(std::string_view word, OffKind& kind) {
    if (word.size() < 3 || !is_word(word.substr(word.size() - 3), "off")) return false;
    word.remove_suffix(3);
    if (is_word(word.substr(0, 2), "st")) word.remove_prefix(2);
    if (!word.empty() && word.front() == 'C') {
        kind.has_colors = true;
        word.remove_prefix(1);
    }
    if (!word.empty() && word.front() == 'N') {
        kind.has_normals = true;
        word.remove_prefix(1);
    }
    if (!word.empty() && (word.front() == '4' || word.front() == 'n')) kind.is_four_dimensional = true;
    return word.empty() || kind.is_four_dimensional;
}

class OffReader {
 public:
    OffReader(const Source& source, FlatMesh& mesh) : source_(source), mesh_(mesh), lines_(source.bytes) {}

    void read() {
        OffKind kind;
        std::string_view line = content();
        std::string_view ahead = line;
        if (parse_kind(next_word(ahead), kind)) {
            line = trim(ahead);
            if (is_word(line.substr(0, 6), "binary"))
                throw std::runtime_error("is a binary OFF file, which is not supported: convert it to text");
            if (line.empty()) line = content();
        }
        if (kind.is_four_dimensional)
            throw std::runtime_error("has vertices that are not three-dimensional, which is not supported");
        const std::string_view counts = line;
        long long vertices = -1, faces = -1;
        if (!parse_integer(next_word(line), vertices) || !parse_integer(next_word(line), faces) || vertices < 0 || faces < 0) {
            throw std::runtime_error(where() + "found " + quoted(counts) +
                                     ", expected the numbers of vertices and faces: is it an OFF file?");
        }
        // The shortest vertex is "0 0 0\n" with 6 bytes. A face takes at least 2 bytes.
        std::string why = too_large("vertex", static_cast<unsigned long long>(vertices), 6, source_.bytes.size());
        if (why.empty()) why = too_large("face", static_cast<unsigned long long>(faces), 2, source_.bytes.size());
        if (!why.empty()) throw std::runtime_error(why);
        Steps steps(source_);
        const auto step = [&] { steps.step([&] { return lines_.fraction(); }); };
        for (long long v = 0; v < vertices; ++v, step()) vertex(kind, v, vertices);
        for (long long f = 0; f < faces; ++f, step()) face(f, faces);
        if (kind.has_colors) warn(source_, "its vertices have colours, which are left out");
    }

 private:
    // The next line that is not blank.
    std::string_view content() {
        for (std::string_view line; lines_.next(line);) {
            line = trim(before_comment(line));
            if (!line.empty()) return line;
        }
        return {};
    }
    std::string where() const { return "line " + std::to_string(lines_.number()) + ": "; }

    void vertex(const OffKind& kind, long long index, long long count) {
        std::string_view line = content();
        if (line.empty())
            throw std::runtime_error(where() + "found the end of the file after " + std::to_string(index) + " of " +
                                     std::to_string(count) + " vertices, expected x y z of the next one");
        double xyz[3];
        for (double& x : xyz) {
            const std::string_view word = next_word(line);
            if (word.empty()) throw std::runtime_error(where() + "a vertex has fewer than three coordinates; expected x y z");
            if (!parse_float(word, x)) x = NAN;
        }
        mesh_.add_vertex(xyz[0], xyz[1], xyz[2]);
        for (int k = 0; kind.has_normals && k < 3; ++k) {
            float n = 0;
            mesh_.normals.push_back(parse_float(next_word(line), n) ? n : 0);
        }
    }
    void face(long long index, long long count) {
        std::string_view line = content();
        if (line.empty())
            throw std::runtime_error(where() + "found the end of the file after " + std::to_string(index) + " of " +
                                     std::to_string(count) + " faces, expected the next one");
        long long corners = 0;
        const std::string_view first = next_word(line);
        if (!parse_integer(first, corners) || corners < 0) {
            throw std::runtime_error(where() + quoted(first) + " instead of the number of corners of a face");
        }
        for (long long i = 0; i < corners; ++i) {
            long long vertex;
            std::string_view word = next_word(line);
            if (word.empty()) {  // a face may continue on the next line
                line = content();
                word = next_word(line);
            }
            if (!parse_integer(word, vertex))
                throw std::runtime_error(where() + "a face of " + std::to_string(corners) + " corners has " +
                                         std::to_string(i));
            mesh_.corners.push_back(FlatMesh::vertex_number(vertex));
        }
        mesh_.add_face(static_cast<size_t>(corners));
    }

    const Source& source_;
    FlatMesh& mesh_;
    Lines lines_;
};

}  // namespace

Reading read_off(const Source& source, FlatMesh& mesh) {
    OffReader(source, mesh).read();
    return {};
}

}  // namespace openmesh_import
