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

// The keys of a kind of lights or skies, or of materials. Tells the statement these keys, and further ones.
std::vector<const rt_key*> keys_of(const rt_primitive_kind& kind);
void expect(Statement& s, const std::vector<const rt_key*>& keys, const std::vector<Key>& more = {});
// The value of a key, and as the text of an edit.
Vec3 read_look(Statement& s, const rt_key& key);
std::string look_text(const rt_key& key, const Vec3& value);

// Numbers with commas between them, with all their digits.
std::string text_of(const float* numbers, size_t count);
inline std::string text_of(const Vec3& v) {
    return text_of(v.data(), 3);
}

}  // namespace scene_format
