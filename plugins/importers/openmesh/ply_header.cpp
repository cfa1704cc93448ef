#include "ply_header.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import::ply {
namespace {

constexpr std::array<Type, 8> kTypes = {{{"char", "int8", 1, Number::int8},
                                         {"uchar", "uint8", 1, Number::uint8},
                                         {"short", "int16", 2, Number::int16},
                                         {"ushort", "uint16", 2, Number::uint16},
                                         {"int", "int32", 4, Number::int32},
                                         {"uint", "uint32", 4, Number::uint32},
                                         {"float", "float32", 4, Number::float32},
                                         {"double", "float64", 8, Number::float64}}};

const Type& type_of(std::string_view word) {
    for (const Type& type : kTypes) {
        if (word == type.name || word == type.other_name) return type;
    }
    throw std::runtime_error("found the type " + quoted(word) +
                             ", expected char, uchar, short, ushort, int, uint, float or double");
}

constexpr std::pair<std::string_view, Kind> kElements[] = {
    {"vertex", Kind::vertices}, {"face", Kind::faces}, {"tristrips", Kind::strips}};

struct NamedRole {
    std::string_view name;
    Kind kind;
    bool is_list;
    Role role;
};
// Names as other programs write them. uv are s and t in Blender's files and texture_u and texture_v in MeshLab's.
constexpr NamedRole kRoles[] = {
    {"x", Kind::vertices, false, Role::x},
    {"y", Kind::vertices, false, Role::y},
    {"z", Kind::vertices, false, Role::z},
    {"nx", Kind::vertices, false, Role::nx},
    {"ny", Kind::vertices, false, Role::ny},
    {"nz", Kind::vertices, false, Role::nz},
    {"u", Kind::vertices, false, Role::u},
    {"s", Kind::vertices, false, Role::u},
    {"texture_u", Kind::vertices, false, Role::u},
    {"v", Kind::vertices, false, Role::v},
    {"t", Kind::vertices, false, Role::v},
    {"texture_v", Kind::vertices, false, Role::v},
    {"red", Kind::vertices, false, Role::red},
    {"diffuse_red", Kind::vertices, false, Role::red},
    {"green", Kind::vertices, false, Role::green},
    {"diffuse_green", Kind::vertices, false, Role::green},
    {"blue", Kind::vertices, false, Role::blue},
    {"diffuse_blue", Kind::vertices, false, Role::blue},
    {"alpha", Kind::vertices, false, Role::alpha},
    {"diffuse_alpha", Kind::vertices, false, Role::alpha},
    {"vertex_indices", Kind::faces, true, Role::indices},
    {"vertex_index", Kind::faces, true, Role::indices},
    {"texcoord", Kind::faces, true, Role::texcoords},
    {"vertex_indices", Kind::strips, true, Role::indices},
    {"vertex_index", Kind::strips, true, Role::indices},
};

Property parse_property(std::string_view rest, const Element& element) {
    Property property;
    std::string_view word = next_word(rest);
    if (word == "list") {
        property.count_type = &type_of(next_word(rest));
        if (property.count_type->is_float())
            throw std::runtime_error("found the type " + std::string(property.count_type->name) +
                                     " for the length of a list, expected an integer type");
        word = next_word(rest);
    }
    property.type = &type_of(word);
    property.name = std::string(next_word(rest));
    if (property.name.empty()) throw std::runtime_error("found a property without a name, expected one behind its type");
    for (const NamedRole& named : kRoles) {
        const bool fits = named.name == property.name && named.kind == element.kind && named.is_list == property.is_list();
        if (fits && !element.has(named.role)) property.role = named.role;
    }
    return property;
}

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
        for (const auto& [name, kind] : kElements)
            if (element.name == name) element.kind = kind;
        header.elements.push_back(element);
    } else if (word == "property") {
        if (header.elements.empty()) throw std::runtime_error("found a property, expected an element before it");
        header.elements.back().properties.push_back(parse_property(line, header.elements.back()));
    } else if (word == "comment") {
        if (next_word(line) == "TextureFile") header.texture = std::string(without_quotes(trim(line)));
    } else if (word != "obj_info" && !word.empty()) {
        throw std::runtime_error("found " + quoted(word) +
                                 ", expected format, element, property, comment, obj_info or end_header");
    }
}

// The smallest number of bytes that one element can take.
unsigned long long least_bytes(const Element& element, bool ascii) {
    unsigned long long bytes = 0;
    for (const Property& p : element.properties) {
        bytes += ascii ? 2 : static_cast<unsigned>(p.is_list() ? p.count_type->bytes : p.type->bytes);
    }
    return std::max(bytes, 1ull);
}

// Throws std::runtime_error if the file is too short for what the header declares, or if something is missing.
void check(const Header& header, bool needs_faces) {
    if (header.format != "ascii" && header.format != "binary_little_endian" && header.format != "binary_big_endian") {
        throw std::runtime_error("found the PLY format " + quoted(header.format) +
                                 ", expected ascii, binary_little_endian or binary_big_endian");
    }
    for (const Element& element : header.elements) {
        if (element.kind != Kind::other && header.find(element.kind) != &element)
            throw std::runtime_error("the PLY header has two elements " + quoted(element.name) + ", expected one");
    }
    const Element* vertices = header.find(Kind::vertices);
    if (!vertices) throw std::runtime_error("the PLY header has no element 'vertex'");
    if (needs_faces && !header.find(Kind::faces) && !header.find(Kind::strips))
        throw std::runtime_error("contains no polygons: it is a point cloud");
    for (const auto& [role, axis] : {std::pair(Role::x, "x"), std::pair(Role::y, "y"), std::pair(Role::z, "z")})
        if (!vertices->has(role)) throw std::runtime_error(std::string("its vertices have no number ") + axis);
    // The last number of a text needs no separator behind it.
    unsigned long long available = header.body.size() + (header.is_ascii() ? 1 : 0);
    // What stands behind the last element that is read does not matter.
    size_t needed = header.elements.size();
    while (header.elements[needed - 1].kind == Kind::other) --needed;
    for (size_t i = 0; i < needed; ++i) {
        const Element& element = header.elements[i];
        for (const Property& p : element.properties)
            if (p.role == Role::indices && p.type->is_float())
                throw std::runtime_error("the vertex indices of its " +
                                         std::string(element.kind == Kind::faces ? "faces" : "strips") +
                                         " have a floating-point type; expected an integer type");
        const bool needs_indices = element.kind == Kind::faces || element.kind == Kind::strips;
        if (needs_indices && element.count > 0 && !element.has(Role::indices))
            throw std::runtime_error("its elements " + quoted(element.name) + " have no list 'vertex_indices'");
        const unsigned long long each = least_bytes(element, header.is_ascii());
        const std::string why = too_large(printable(element.name).c_str(), element.count, each, available);
        if (!why.empty()) throw std::runtime_error(why);
        available -= std::min(available, element.count * each);
    }
}

}  // namespace

bool Element::has(Role role) const {
    return std::any_of(properties.begin(), properties.end(), [&](const Property& p) { return p.role == role; });
}

bool Element::has_colors() const {
    for (const std::string prefix : {"", "diffuse_"}) {
        const auto named = [&](const char* name) {
            return std::any_of(properties.begin(), properties.end(),
                               [&](const Property& p) { return p.name == prefix + name; });
        };
        if (named("red") && named("green") && named("blue")) return true;
    }
    return false;
}

const Element* Header::find(Kind kind) const {
    const auto found = std::find_if(elements.begin(), elements.end(), [&](const Element& e) { return e.kind == kind; });
    return found == elements.end() ? nullptr : &*found;
}

bool is_ply(std::string_view text) {
    const std::string_view word = importers::without_mark(text).substr(0, 4);
    return word == "ply\n" || word == "ply\r";
}

Header parse_header(std::string_view bytes, bool needs_faces) {
    Header header;
    Lines lines(bytes);
    std::string_view line;
    if (!lines.next(line) || trim(line) != "ply")
        throw std::runtime_error("line 1: found " + quoted(line) + ", expected 'ply', with which a PLY file begins");
    while (lines.next(line)) {
        std::string_view words = line;
        if (next_word(words) == "end_header") {
            header.body = lines.data();
            header.lines = lines.number();
            check(header, needs_faces);
            return header;
        }
        try {
            parse_line(line, header);
        } catch (const std::runtime_error& error) {
            throw std::runtime_error("line " + std::to_string(lines.number()) + ": the PLY header is damaged: " + error.what());
        }
    }
    throw std::runtime_error(
        "the PLY header has no end: found the end of the file, expected end_header; it is cut off or damaged");
}

}  // namespace openmesh_import::ply
