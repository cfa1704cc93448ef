// ply_header.hpp -- parses the header of a PLY file, and checks it against the file's size.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace openmesh_import::ply {

enum class Number { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
struct Type {
    std::string_view name, other_name;
    int bytes;
    Number number;
    bool is_float() const { return number == Number::float32 || number == Number::float64; }
    bool is_signed() const { return number == Number::int8 || number == Number::int16 || number == Number::int32; }
};
// What the importer takes from a property. Others are passed over.
enum class Role { none, x, y, z, nx, ny, nz, u, v, red, green, blue, alpha, indices, texcoords };
struct Property {
    std::string name;
    const Type* type = nullptr;
    const Type* count_type = nullptr;  // type of the list's length; nullptr: not a list
    Role role = Role::none;
    bool is_list() const { return count_type != nullptr; }
};
enum class Kind { other, vertices, faces, strips };
struct Element {
    std::string name;
    unsigned long long count = 0;
    std::vector<Property> properties;
    Kind kind = Kind::other;
    bool has(Role role) const;
    bool has_colors() const;  // red, green and blue
};

struct Header {
    std::string format;
    std::vector<Element> elements;
    std::string texture;
    std::string_view body;
    size_t lines = 0;  // of the header
    bool is_ascii() const { return format == "ascii"; }
    const Element* find(Kind kind) const;
};

// Whether a text begins as PLY files do.
bool is_ply(std::string_view text);

// Parses the header. Throws std::runtime_error with the reason, also if the file is too short for what the header declares, or
// if something that is needed is not there, such as faces unless only points are read.
Header parse_header(std::string_view bytes, bool needs_faces = true);

}  // namespace openmesh_import::ply
