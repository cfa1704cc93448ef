// material_keys.hpp -- the table of what a material is made of. A new key is a row here, a member of rt_material or
// rt_layers, and kernels that read it.
#pragma once
#include "base/problem.hpp"
#include "scene/key.hpp"
#include "scene/scene.hpp"

namespace clarity {

// All keys but the texture, which is no number. `model` comes first, because it changes others. Those of plugins' models come
// last, and more of them when a plugin is loaded: the tables that were returned before stay as they are.
const std::vector<Key>& material_keys();
// For surface_models.cpp: another model, and the keys of one.
void add_model_word(rt_u32 model, const char* word);
void add_material_keys(const std::vector<Key>& keys);
const Key& material_key(const char* name);
// Whether materials of that model have the key.
bool has_key(rt_u32 model, const Key& key);
// Whether materials of that model have room for the key, though it may have no effect: models of plugins have their numbers
// where others have layers.
bool has_room(rt_u32 model, const Key& key);
bool is_key_of_surface(const Key& key);
// The key of that name that materials of the model have, or else that of another model; nullptr: there is none.
const Key* find_material_key(rt_u32 model, const std::string& name);

const rt_primitive_kind* material_kind_for_plugins();

// Sets a value. Models other than Whitted's have shares for Whitted's tracers, so that these show the same surface as near as
// they can. Setting the model sets those shares. As long as nothing else sets them, they follow what the model's look depends
// on, as a conductor's roughness.
void set_material_value(MaterialValues& material, const Key& key, const std::array<float, 3>& value);
// What an importer delivers. The texture is still an id of the sink. Sets `problem` to what is wrong, or to an empty text:
// numbers that are not finite are replaced by defaults, others are brought into range without a word, and unknown keys are left
// out.
MaterialValues material_of(const rt_material_desc& desc, std::string& problem);
// "`reflect` is 2, expected from 0 to 1", or nothing.
Problem material_fault(const MaterialValues& material);

}  // namespace clarity
