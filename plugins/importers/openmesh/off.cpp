// off.cpp -- reads OFF. The text is rewritten without comments and colours before OpenMesh reads it. OpenMesh would take a
// colour behind a face for the next face, a comment for the end of the file, and ignore counts on the first line.
#include <stdexcept>
#include <string>

#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// The header word, [ST][C][N]OFF. Of the data behind a vertex's position, only normals are kept.
struct Kind {
    bool has_normals = false, is_four_dimensional = false, is_binary = false;
};

bool parse_kind(std::string_view word, Kind& kind) {
    if (word.size() < 3 || word.substr(word.size() - 3) != "OFF") return false;
    word.remove_suffix(3);
    if (word.substr(0, 2) == "ST") word.remove_prefix(2);
    if (!word.empty() && word.front() == 'C') word.remove_prefix(1);
    if (!word.empty() && word.front() == 'N') {
        kind.has_normals = true;
        word.remove_prefix(1);
    }
    if (!word.empty() && (word.front() == '4' || word.front() == 'n')) kind.is_four_dimensional = true;
    return word.empty() || kind.is_four_dimensional;
}

class OffText {
 public:
    explicit OffText(std::string_view text) : size_(text.size()), rest_(text) {}

    std::string rewrite(FlatImporter& mesh) {
        Kind kind;
        std::string_view line = content();
        std::string_view ahead = line;
        if (parse_kind(next_word(ahead), kind)) {
            line = trim(ahead);
            if (line.substr(0, 6) == "BINARY")
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
        std::string why = too_large("vertex", static_cast<unsigned long long>(vertices), 6, size_);
        if (why.empty()) why = too_large("face", static_cast<unsigned long long>(faces), 2, size_);
        if (!why.empty()) throw std::runtime_error(why);
        std::string out = "OFF\n" + std::to_string(vertices) + " " + std::to_string(faces) + " 0\n";
        out.reserve(size_ + 64);
        for (long long v = 0; v < vertices; ++v) vertex(kind, v, vertices, mesh, out);
        for (long long f = 0; f < faces; ++f) face(f, faces, out);
        return out;
    }
    std::vector<float> normals;

 private:
    // The next line that is not blank.
    std::string_view content() {
        while (!rest_.empty()) {
            ++line_number_;
            const std::string_view line = trim(before_comment(next_line(rest_)));
            if (!line.empty()) return line;
        }
        return {};
    }
    std::string where() const { return "line " + std::to_string(line_number_) + ": "; }

    void vertex(const Kind& kind, long long index, long long count, FlatImporter& mesh, std::string& out) {
        std::string_view line = content();
        if (line.empty())
            throw std::runtime_error(where() + "found the end of the file after " + std::to_string(index) + " of " +
                                     std::to_string(count) + " vertices, expected x y z of the next one");
        float xyz[3] = {0, 0, 0};
        bool good = true;
        std::string_view words[3];
        for (int k = 0; k < 3; ++k) {
            words[k] = next_word(line);
            if (words[k].empty())
                throw std::runtime_error(where() + "a vertex has fewer than three coordinates; expected x y z");
            good = parse_float(words[k], xyz[k]) && good;
        }
        if (!good) mesh.mark_unusable(static_cast<size_t>(index));
        for (int k = 0; k < 3; ++k) out.append(good ? words[k] : "0").append(k < 2 ? " " : "\n");
        for (int k = 0; kind.has_normals && k < 3; ++k) {
            float n = 0;
            parse_float(next_word(line), n);
            normals.push_back(n);
        }
    }
    void face(long long index, long long count, std::string& out) {
        std::string_view line = content();
        if (line.empty())
            throw std::runtime_error(where() + "found the end of the file after " + std::to_string(index) + " of " +
                                     std::to_string(count) + " faces, expected the next one");
        long long corners = 0;
        const std::string_view first = next_word(line);
        if (!parse_integer(first, corners) || corners < 0) {
            throw std::runtime_error(where() + quoted(first) + " instead of the number of corners of a face");
        }
        out.append(first);
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
            // Any index out of range is written as one that fits into OpenMesh's numbers; faces with it are reported later.
            out.append(" ").append(vertex < 0 || vertex > 2147483647 ? "2147483647" : word);
        }
        out += '\n';
    }

    size_t size_, line_number_ = 0;
    std::string_view rest_;
};

}  // namespace

void read_off(const Source& source, FlatImporter& mesh) {
    OffText text(source.bytes);
    const std::string clean = text.rewrite(mesh);
    BytesBuffer buffer({}, clean, source.progress);
    run_reader("off", buffer, true, false, false, mesh);
    for (size_t v = 0; 3 * v + 2 < text.normals.size(); ++v) {
        const float* n = &text.normals[3 * v];
        mesh.set_normal(OpenMesh::VertexHandle(static_cast<int>(v)), OpenMesh::Vec3f(n[0], n[1], n[2]));
    }
}

}  // namespace openmesh_import
