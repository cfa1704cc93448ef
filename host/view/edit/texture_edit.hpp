// texture_edit.hpp -- edits of the textures of materials as text: see edit.hpp.
#pragma once
#include <string>
#include <vector>

#include "scene/map_edit.hpp"

namespace clarity {

struct Word;

// The use (RT_MAP_) in the key of an edit, "material.3.normal_map"; RT_NONE: it is of another kind.
rt_u32 map_use_of(const std::string& key);
// The names of all uses, with commas between them.
std::string map_names();
// Throws Error(usage).
rt_u32 read_texture(const Scene& scene, rt_u32 use, const std::string& key, const std::string& value);
// The words that turn `from` into `to`.
void add_map_words(const Scene& scene, const MapEdits& from, const MapEdits& to, std::vector<Word>& words);

// The file that an edit gives to a material, to be read with the scene. Empty: the edit is of another kind, or the value is no
// file: then it is a texture of the scene.
PictureFile picture_of(const Word& word);
std::vector<PictureFile> pictures_of(const std::vector<Word>& edits);

}  // namespace clarity
