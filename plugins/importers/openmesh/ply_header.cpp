#include "ply_header.hpp"

#include <array>
#include <stdexcept>

#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import::ply {
namespace {

constexpr std::array<Type, 8> kTypes = {{{"char", "int8", 1, false},
                                         {"uchar", "uint8", 1, false},
                                         {"short", "int16", 2, false},
                                         {"ushort", "uint16", 2, false},
                                         {"int", "int32", 4, false},
                                         {"uint", "uint32", 4, false},
                                         {"float", "float32", 4, true},
                                         {"double", "float64", 8, true}}};

const Type& type_of(std::string_view word) {
    for (const Type& type : kTypes) {
        if (word == type.name || word == type.other_name) return type;
    }
    throw std::runtime_error("found the type " + quoted(word) +
                             ", expected char, uchar, short, ushort, int, uint, float or double");
}

Property parse_property(std::string_view rest) {
    Property property;
    std::string_view word = next_word(rest);
    if (word == "list") {
        property.count_type = &type_of(next_word(rest));
        if (property.count_type->is_float)
            throw std::runtime_error("found the type " + std::string(property.count_type->name) +
                                     " for the length of a list, expected an integer type");
        word = next_word(rest);
    }
    property.type = &type_of(word);
    property.name = std::string(next_word(rest));
    // Names of texture coordinates in files of other programs.
    if (property.name == "texture_u") property.name = "u";
    if (property.name == "texture_v") property.name = "v";
    if (property.name.empty()) throw std::runtime_error("found a property without a name, expected one behind its type");
    return property;
}

}  // namespace

namespace {

void parse_line(std::string_view line, Header& header) {
    const std::string_view word = next_word(line);
    if (word == "format") {
        header.format = std::string(next_word(line));
    } else if (word == "element") {
        Element element;
        element.name = std::string(next_word(line));
        long long count = -1;
        const std::string_view number = next_word(line);
        if (!parse_integer(number, count) || count < 0)
            throw std::runtime_error("found " + quoted(number) + ", expected the number of elements " + quoted(element.name));
        element.count = static_cast<unsigned long long>(count);
        header.elements.push_back(element);
    } else if (word == "property") {
        if (header.elements.empty()) throw std::runtime_error("found a property, expected an element before it");
        header.elements.back().properties.push_back(parse_property(line));
    } else if (word == "comment") {
        if (next_word(line) == "TextureFile") header.texture = std::string(trim(line));
    } else if (word != "obj_info" && !word.empty()) {
        throw std::runtime_error("found " + quoted(word) +
                                 ", expected format, element, property, comment, obj_info or end_header");
    }
}

}  // namespace

Header parse_header(std::string_view bytes) {
    Header header;
    const std::string_view first = next_line(bytes);
    if (first.substr(0, 3) != "ply")
        throw std::runtime_error("line 1: found " + quoted(first) + ", expected 'ply', with which a PLY file begins");
    for (size_t line_number = 2; !bytes.empty(); ++line_number) {
        const std::string_view line = next_line(bytes);
        std::string_view words = line;
        if (next_word(words) == "end_header") {
            header.body = bytes;
            return header;
        }
        try {
            parse_line(line, header);
        } catch (const std::runtime_error& error) {
            throw std::runtime_error("line " + std::to_string(line_number) + ": the PLY header is damaged: " + error.what());
        }
    }
    throw std::runtime_error(
        "the PLY header has no end: found the end of the file, expected end_header; it is cut off or damaged");
}

namespace {

// The smallest number of bytes that one element can take.
unsigned long long least_bytes(const Element& element, bool ascii) {
    unsigned long long bytes = 0;
    for (const Property& p : element.properties) {
        bytes += ascii ? 2 : p.is_list() ? p.count_type->bytes : p.type->bytes;
    }
    return std::max(bytes, 1ull);
}

}  // namespace

void check(const Header& header) {
    if (header.format != "ascii" && header.format != "binary_little_endian" && header.format != "binary_big_endian") {
        throw std::runtime_error("found the PLY format " + quoted(header.format) +
                                 ", expected ascii, binary_little_endian or binary_big_endian");
    }
    for (const Element& element : header.elements) {
        // OpenMesh counts the faces of the first one, and fails an assertion at the properties of the second.
        if (header.find(element.name) != &element)
            throw std::runtime_error("the PLY header has two elements " + quoted(element.name) + ", expected one");
    }
    const Element *vertices = header.find("vertex"), *faces = header.find("face");
    if (!vertices) throw std::runtime_error("the PLY header has no element 'vertex'");
    if (!faces) {
        const bool strips = header.find("tristrips") != nullptr;
        throw std::runtime_error(strips ? "holds triangle strips, which are not supported: convert them to faces"
                                        : "contains no polygons: it is a point cloud");
    }
    if (vertices > faces) throw std::runtime_error("has its faces before its vertices, which is not supported");
    for (const char* axis : {"x", "y", "z"}) {
        const auto named = [&](const Property& p) { return p.name == axis; };
        const auto found = std::find_if(vertices->properties.begin(), vertices->properties.end(), named);
        if (found == vertices->properties.end()) throw std::runtime_error(std::string("its vertices have no ") + axis);
        if (found->is_list() || (!found->type->is_float && !header.is_ascii())) {
            throw std::runtime_error("its vertices are not of type float or double, which is not supported");
        }
    }
    const auto indices =
        std::find_if(faces->properties.begin(), faces->properties.end(), [](auto& p) { return p.is_indices(); });
    if (indices == faces->properties.end()) throw std::runtime_error("its faces have no list 'vertex_indices'");
    if (indices != faces->properties.begin())
        throw std::runtime_error("its faces have properties before 'vertex_indices', which is not supported");
    if (indices->type->is_float)
        throw std::runtime_error("the vertex indices of its faces have a floating-point type; expected an integer type");
    // The last number of a text needs no separator behind it.
    unsigned long long available = header.body.size() + (header.is_ascii() ? 1 : 0);
    for (const Element& element : header.elements) {
        for (const Property& p : element.properties) {
            if (p.is_list() && &element != faces) {
                throw std::runtime_error("has a list in element " + quoted(element.name) + ", which is not supported");
            }
        }
        const unsigned long long each = least_bytes(element, header.is_ascii());
        const std::string why = too_large(printable(element.name).c_str(), element.count, each, available);
        if (!why.empty()) throw std::runtime_error(why);
        available -= std::min(available, element.count * each);
        if (&element == faces) break;
    }
}

namespace {

// The types that rewrite() writes. In ASCII, OpenMesh would read one-byte integers as characters. In both forms it knows only a
// few types for the length of a list. The sign of the length type does not matter.
std::string_view type_text(const Type& type, bool ascii) {
    return ascii && !type.is_float ? "int" : type.name;
}
std::string_view count_type_text(const Type& type, bool ascii) {
    if (ascii || type.bytes == 4) return "int";
    return type.bytes == 1 ? "uchar" : "uint16";
}

}  // namespace

std::string rewrite(const Header& header) {
    std::string text = "ply\nformat " + header.format + " 1.0\n";
    for (const Element& element : header.elements) {
        text += "element " + element.name + " " + std::to_string(element.count) + "\n";
        for (const Property& p : element.properties) {
            text += "property ";
            if (p.is_list()) text.append("list ").append(count_type_text(*p.count_type, header.is_ascii())).append(" ");
            text.append(type_text(*p.type, header.is_ascii())).append(" ") += p.name + "\n";
        }
    }
    return text + "end_header\n";
}

}  // namespace openmesh_import::ply
