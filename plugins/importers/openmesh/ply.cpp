// ply.cpp -- reads PLY. Binary data goes to OpenMesh unchanged; ASCII is checked line by line, so that OpenMesh sees only what
// the header declares.
#include <algorithm>
#include <istream>
#include <stdexcept>

#include "../common/numbers.hpp"
#include "ply_header.hpp"
#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

using ply::Element;
using ply::Header;
using ply::Property;

// Follows the values in the order of the header. Values behind the end of an element on its line are dropped (MeshLab writes
// such lines). An element may continue on the next line.
class AsciiLines {
 public:
    AsciiLines(const Header& header, FlatImporter& mesh) : header_(header), mesh_(mesh) {}

    bool edit(std::string_view line, std::string& out) {
        ++line_number_;
        if (in_header_) {
            if (trim(line) != "end_header") return false;
            in_header_ = false;
            out = ply::rewrite(header_);
            out.pop_back();
            return true;
        }
        while (element_ < header_.elements.size() && (item_ >= element().count || element().properties.empty())) {
            ++element_;
            item_ = 0;
        }
        if (element_ == header_.elements.size()) return false;
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
            value(word, out);
            out += ' ';
            if (property_ == 0 && list_left_ == 0) {
                ++item_;
                break;
            }
        }
        return !out.empty();
    }
    // Names the line and the element that is read, for messages.
    std::string where() const {
        const std::string line = "line " + std::to_string(line_number_) + ": ";
        if (element_ == header_.elements.size()) return line;
        return line + quoted(element().name) + " " + std::to_string(item_ + 1) + " of " + std::to_string(element().count) +
               ": ";
    }

 private:
    const Element& element() const { return header_.elements[element_]; }

    void value(std::string_view word, std::string& out) {
        const Property& property = element().properties[property_];
        if (property.is_list() && list_left_ == 0 && !list_is_open_) {
            long long count = 0;
            if (!parse_integer(word, count) || count < 0)
                throw std::runtime_error(where() + quoted(word) + " instead of the length of a list");
            // OpenMesh reserves memory for any length of such a list.
            if (!property.is_indices() && static_cast<unsigned long long>(count) > header_.body.size() / 2)
                throw std::runtime_error(where() + "a list of " + quoted(word) + " values, more than the file can hold");
            out.append(word);
            list_left_ = static_cast<unsigned long long>(count);
            list_is_open_ = true;
        } else {
            number(property, word, out);
            if (list_left_ > 0) --list_left_;
        }
        if (list_left_ > 0) return;
        list_is_open_ = false;
        property_ = (property_ + 1) % element().properties.size();
    }
    void number(const Property& property, std::string_view word, std::string& out) {
        float x = 0;
        if (property.type->is_float) {
            if (parse_float(word, x)) {
                out.append(word.front() == '+' ? word.substr(1) : word);
                return;
            }
            if (!is_odd_number(word)) throw std::runtime_error(where() + quoted(word) + " instead of a number");
            if (element().name == "vertex" && property.name.size() == 1 && property.name[0] >= 'x') mesh_.mark_unusable(item_);
            out += '0';
            return;
        }
        long long integer = 0;
        if (!parse_integer(word, integer)) throw std::runtime_error(where() + quoted(word) + " instead of an integer");
        // Any integer out of range is written as one that fits into OpenMesh's numbers; faces with it are reported later.
        out.append(integer < 0 || integer > 2147483647 ? "2147483647" : word);
    }
    // True for words such as nan, inf, -1.#IND and 1e999, which programs write for numbers that are not finite.
    static bool is_odd_number(std::string_view word) {
        if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
        if (word.empty()) return false;
        const char first = static_cast<char>(word.front() | 0x20);
        if (first == 'n' || first == 'i') return word.size() >= 3 && word.size() <= 8;
        return word.front() >= '0' && word.front() <= '9' && word.find_first_of("eE#") != word.npos;
    }

    const Header& header_;
    FlatImporter& mesh_;
    bool in_header_ = true, list_is_open_ = false;
    size_t line_number_ = 0, element_ = 0, property_ = 0;
    unsigned long long item_ = 0, list_left_ = 0;
};

// Likewise for a binary file: compares the lengths of its lists with the bytes that are there.
void check_binary_lists(const Header& header, size_t body_at) {
    const bool big_endian = header.format == "binary_big_endian";
    const auto length_at = [&](size_t at, int bytes) -> uint64_t {
        const char* from = header.body.data() + at;
        return bytes == 1   ? importers::load<uint8_t>(from, big_endian)
               : bytes == 2 ? importers::load<uint16_t>(from, big_endian)
                            : importers::load<uint32_t>(from, big_endian);
    };
    size_t at = 0;
    for (const Element& element : header.elements) {
        for (unsigned long long item = 0; item < element.count; ++item) {
            for (const Property& p : element.properties) {
                uint64_t values = 1;
                if (p.is_list()) {
                    if (header.body.size() - at < static_cast<size_t>(p.count_type->bytes)) return;
                    values = length_at(at, p.count_type->bytes);
                    at += static_cast<size_t>(p.count_type->bytes);
                }
                const uint64_t bytes = values * static_cast<uint64_t>(p.type->bytes), left = header.body.size() - at;
                if (bytes > left && p.is_list()) {
                    throw std::runtime_error("byte " + std::to_string(body_at + at) + ": " + quoted(element.name) + " " +
                                             std::to_string(item + 1) + ": a list of " + std::to_string(values) +
                                             " values, but only " + std::to_string(left) + " bytes follow");
                }
                if (bytes > left) return;  // that not all elements were read is reported later
                at += bytes;
            }
        }
        if (element.name == "face") return;
    }
}

// MeshLab writes uvs as `property list uchar float texcoord`, two numbers per corner.
void take_texcoords(FlatImporter& mesh) {
    OpenMesh::FPropHandleT<std::vector<float>> lists;
    if (!mesh.properties.get_property_handle(lists, "texcoord")) return;
    mesh.set_corner_uvs(
        [&](size_t face) { return &mesh.properties.property(lists, OpenMesh::FaceHandle(static_cast<int>(face))); });
}

}  // namespace

std::string read_ply(const Source& source, FlatImporter& mesh) {
    const Header header = ply::parse_header(source.bytes);
    ply::check(header);
    const Element *vertices = header.find("vertex"), *faces = header.find("face");
    mesh.properties.vertices = vertices->count;
    mesh.properties.faces = faces->count;
    const auto is_other_list = [](const Property& p) { return p.is_list() && !p.is_indices(); };
    const bool has_lists = std::any_of(faces->properties.begin(), faces->properties.end(), is_other_list);
    if (has_lists && !header.is_ascii()) check_binary_lists(header, source.bytes.size() - header.body.size());
    AsciiLines lines(header, mesh);
    LineBuffer text(
        source.bytes, false, [&](std::string_view line, int, std::string& out) { return lines.edit(line, out); }, 1,
        source.progress);
    BytesBuffer binary(ply::rewrite(header), header.body, source.progress);
    try {
        run_reader("ply", header.is_ascii() ? static_cast<std::streambuf&>(text) : binary, true, false, has_lists, mesh);
    } catch (const std::ios_base::failure&) {
        // The check below reports that not all elements were read.
    }
    if (mesh.n_vertices() < vertices->count || mesh.face_count() < faces->count) {
        const size_t body = source.bytes.size() - header.body.size();
        const std::string where = header.is_ascii() ? lines.where() : "byte " + std::to_string(body + binary.position()) + ": ";
        throw std::runtime_error(where + "ends after " + std::to_string(mesh.n_vertices()) + " of " +
                                 std::to_string(vertices->count) + " vertices and " + std::to_string(mesh.face_count()) +
                                 " of " + std::to_string(faces->count) + " faces: it is cut off or damaged");
    }
    if (has_lists) take_texcoords(mesh);
    return header.texture;
}

}  // namespace openmesh_import
