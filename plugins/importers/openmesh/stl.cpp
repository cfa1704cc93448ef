// stl.cpp -- reads STL, ASCII and binary. Equal corners become one vertex.
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "../common/numbers.hpp"
#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// A binary file: 80 bytes of free text, the number of facets as a 32-bit little-endian integer, then 50 bytes per facet: a
// normal, three corners, and two bytes of which each program makes its own use.
constexpr size_t kHeaderBytes = 84, kFacetBytes = 50, kNormalBytes = 12;

uint32_t declared_count(std::string_view bytes) {
    return importers::load<uint32_t>(bytes.data() + 80, false);
}

// Gives equal corners one vertex: a hash table with open addressing. Number: as the file has them.
template <class Number>
class Welder {
 public:
    explicit Welder(FlatMesh& mesh) : mesh_(mesh), slots_(1024, RT_NONE) {}
    void corner(const Number (&xyz)[3]) {
        Number key[3];
        for (int k = 0; k < 3; ++k) key[k] = xyz[k] + Number(0);  // -0 becomes 0
        size_t at = hash(key);
        while (slots_[at] != RT_NONE && std::memcmp(&keys_[3 * size_t(slots_[at])], key, sizeof key) != 0)
            at = (at + 1) & (slots_.size() - 1);
        rt_u32 vertex = slots_[at];
        if (vertex == RT_NONE) {
            vertex = slots_[at] = static_cast<rt_u32>(mesh_.vertex_count());
            mesh_.add_vertex(key[0], key[1], key[2]);
            keys_.insert(keys_.end(), key, key + 3);
            if (2 * mesh_.vertex_count() > slots_.size()) grow();
        }
        mesh_.corners.push_back(vertex);
    }

 private:
    size_t hash(const Number* key) const {
        std::conditional_t<sizeof(Number) == 4, uint32_t, uint64_t> bits[3];
        std::memcpy(bits, key, sizeof bits);
        uint64_t h = bits[0] * 0x9E3779B97F4A7C15u;
        h = (h ^ bits[1]) * 0xC2B2AE3D27D4EB4Fu;
        h = (h ^ (h >> 29) ^ bits[2]) * 0x9E3779B97F4A7C15u;
        return static_cast<size_t>(h >> 32) & (slots_.size() - 1);
    }
    void grow() {
        slots_.assign(4 * slots_.size(), RT_NONE);
        for (size_t v = 0; v < keys_.size() / 3; ++v) {
            size_t at = hash(&keys_[3 * v]);
            while (slots_[at] != RT_NONE) at = (at + 1) & (slots_.size() - 1);
            slots_[at] = static_cast<rt_u32>(v);
        }
    }
    FlatMesh& mesh_;
    std::vector<rt_u32> slots_;  // vertices by their hash; a power of two of them
    std::vector<Number> keys_;   // the positions as in the file, also those that are not finite
};

// A binary file may start with "solid", too. So the file is ASCII only if it has the words that ASCII needs, and not the exact
// size of a binary file.
bool is_ascii(std::string_view bytes) {
    if (bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + kFacetBytes * size_t(declared_count(bytes)))
        return false;
    std::string_view head = importers::without_mark(bytes.substr(0, 4096));
    if (head.find('\0') != head.npos) return false;
    std::string_view line;
    for (Lines lines(head); lines.next(line);)
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
            if (is_word(word, "solid") || is_word(word, "facet")) return true;
    return false;
}

void read_binary(const Source& source, FlatMesh& mesh) {
    if (source.bytes.size() < kHeaderBytes)
        throw std::runtime_error("byte 0: found " + quoted(source.bytes.substr(0, 16)) +
                                 ", expected 'solid' of a text STL file, or the 84 bytes with which a binary one begins");
    const uint32_t count = declared_count(source.bytes);
    const size_t room = (source.bytes.size() - kHeaderBytes) / kFacetBytes;
    if (count > room) {
        throw std::runtime_error("byte 80: declares " + std::to_string(count) + " facets and has room for " +
                                 std::to_string(room) + ": it is cut off, or no STL file");
    }
    if (count == 0) throw std::runtime_error("byte 80: found 0 facets, expected one at least");
    mesh.corners.reserve(3 * size_t(count));
    Welder<float> welder(mesh);
    Steps steps(source);
    for (uint32_t facet = 0; facet < count; ++facet) {
        const char* at = source.bytes.data() + kHeaderBytes + kFacetBytes * size_t(facet) + kNormalBytes;
        for (int corner = 0; corner < 3; ++corner, at += 12) {
            float xyz[3];
            for (int k = 0; k < 3; ++k) xyz[k] = importers::load<float>(at + 4 * k, false);
            welder.corner(xyz);
        }
        mesh.add_face(3);
        steps.step([&] { return static_cast<float>(facet) / static_cast<float>(count); });
    }
}

// `solid NAME`, then `facet normal x y z`, `outer loop`, three times `vertex x y z`, `endloop`, `endfacet`, then `endsolid
// NAME`. The words may have any case and stand on any line. A name may be any text, so the rest of its line is left out, and so
// are lines that begin with another word. Normals are not used: programs write zeros or nan there.
class AsciiReader {
 public:
    AsciiReader(const Source& source, FlatMesh& mesh) : source_(source), mesh_(mesh), lines_(source.bytes), welder_(mesh) {}
    void read() {
        Steps steps(source_);
        while (lines_.next(line_)) {
            while (word(next_word(line_))) {
            }
            steps.step([&] { return lines_.fraction(); });
        }
        end_facet();
        if (mesh_.sizes.empty())
            throw std::runtime_error("line " + std::to_string(lines_.number()) +
                                     ": found the end of the file and no facet before it, expected 'facet'");
    }

 private:
    // Returns false if the rest of the line counts for nothing.
    bool word(std::string_view word) {
        if (is_word(word, "vertex")) return vertex(), true;
        if (is_word(word, "outer")) return is_open_ = true;
        if (is_word(word, "loop")) return true;
        if (is_word(word, "facet")) {
            end_facet();
            return is_open_ = true;
        }
        if (is_word(word, "normal")) {
            for (int k = 0; k < 3; ++k) next_word(line_);
            return true;
        }
        if (is_word(word, "end")) {  // `end loop`: the same as `endloop`
            word = next_word(line_);
        } else if (word.size() > 3 && is_word(word.substr(0, 3), "end")) {
            word.remove_prefix(3);
        } else if (!is_word(word, "solid")) {
            return false;
        }
        if (is_word(word, "solid") || is_word(word, "loop") || is_word(word, "facet")) end_facet();
        return is_word(word, "loop") || is_word(word, "facet") || (is_word(word, "solid") && skip_name());
    }
    // Moves behind the name of a solid. Returns false if nothing follows it. Some files are one line: `solid NAME facet normal
    // 0 0 1 outer loop ...`.
    bool skip_name() {
        while (!line_.empty()) {
            const std::string_view here = line_, word = next_word(line_);
            std::string_view ahead = line_;
            float number;
            const bool is_facet =
                is_word(word, "facet") && is_word(next_word(ahead), "normal") && parse_float(next_word(ahead), number);
            if (is_facet) return line_ = here, true;
        }
        return false;
    }
    void vertex() {
        double xyz[3];
        for (double& x : xyz) {
            const std::string_view number = next_word(line_);
            if (parse_float(number, x)) continue;
            if (!is_odd_number(number))
                throw std::runtime_error("line " + std::to_string(lines_.number()) + ": " + quoted(number) +
                                         " instead of a coordinate");
            x = NAN;
        }
        welder_.corner(xyz);
        ++corners_;
        is_open_ = true;
    }
    void end_facet() {
        if (is_open_ && corners_ != 3)
            throw std::runtime_error("line " + std::to_string(lines_.number()) + ": found the end of a facet of " +
                                     counted(corners_, "corner") + ", expected three: it is cut off or damaged");
        if (is_open_) mesh_.add_face(3);
        corners_ = 0;
        is_open_ = false;
    }

    const Source& source_;
    FlatMesh& mesh_;
    Lines lines_;
    std::string_view line_;  // what is left of it
    Welder<double> welder_;
    uint64_t corners_ = 0;  // of the facet so far
    bool is_open_ = false;
};

}  // namespace

Reading read_stl(const Source& source, FlatMesh& mesh) {
    is_ascii(source.bytes) ? AsciiReader(source, mesh).read() : read_binary(source, mesh);
    return {};
}

}  // namespace openmesh_import
