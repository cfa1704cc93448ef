// ply_header.hpp -- the header of a PLY file: checked against the file's size, and written anew in the words that OpenMesh
// knows.
//
// OpenMesh 9 loops for ever on a header without an end, reserves memory for whatever count it is told, knows four of the eight
// list-count types, and reads lists right only where the mesh can store them as properties.
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
    const Type* count_type = nullptr;  // of a list; nullptr: a scalar
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

// Throws std::runtime_error that says what is wrong.
Header parse_header(std::string_view bytes);
// Throws if the file cannot hold what the header declares, or what it declares cannot be read.
void check(const Header& header);
std::string rewrite(const Header& header);

}  // namespace openmesh_import::ply
