// looks.hpp -- statements of lights and materials, and edits of them. Kinds and keys come from the host as tables.
#pragma once
#include <string>

#include "document.hpp"
#include "statement.hpp"

namespace scene_format {

void read_light(Statement& s, Document& document, Diagnostics& diagnostics);
void read_material(Statement& s, Document& document, Diagnostics& diagnostics);
// The rest of `edit material N` and `edit light N`. prefix: "material.3.". key: "light.3".
void read_material_edits(Statement& s, const std::string& prefix, Document& document);
void read_light_edits(Statement& s, const std::string& key, Document& document);

// Numbers with commas between them, with all their digits.
std::string text_of(const float* numbers, size_t count);
inline std::string text_of(const Vec3& v) {
    return text_of(v.data(), 3);
}

}  // namespace scene_format
