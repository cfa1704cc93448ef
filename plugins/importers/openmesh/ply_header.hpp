// ply_header.hpp -- parses the header of a PLY file, checks it against the file's size, and rewrites it for OpenMesh.
//
// OpenMesh 9 loops for ever on a header without an end, reserves memory for any count that it reads, knows four of the eight
// types of list lengths, and reads lists correctly only if the mesh can store them as properties.
#pragma once
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace openmesh_import::ply {

struct Type {
    std::string_view name, other_name;
    int bytes;
    bool is_float;
};
struct Property {
    std::string name;
    const Type* type = nullptr;
    const Type* count_type = nullptr;  // type of the list's length; nullptr: not a list
    bool is_list() const { return count_type != nullptr; }
    bool is_indices() const { return is_list() && (name == "vertex_indices" || name == "vertex_index"); }
};
struct Element {
    std::string name;
    unsigned long long count = 0;
    std::vector<Property> properties;
};

struct Header {
    std::string format;
    std::vector<Element> elements;
    std::string texture;
    std::string_view body;
    bool is_ascii() const { return format == "ascii"; }
    const Element* find(std::string_view name) const {
        const auto found = std::find_if(elements.begin(), elements.end(), [&](const Element& e) { return e.name == name; });
        return found == elements.end() ? nullptr : &*found;
    }
};

// Parses the header. Throws std::runtime_error with the reason.
Header parse_header(std::string_view bytes);
// Throws std::runtime_error if the file is too short for what the header declares, or if the header declares something that is
// not supported.
void check(const Header& header);
// Returns a header with the same meaning in words that OpenMesh knows.
std::string rewrite(const Header& header);

}  // namespace openmesh_import::ply
