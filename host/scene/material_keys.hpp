// material_keys.hpp -- the table of what a material is made of. A new key is a row here, a member of rt_material or
// rt_layers, and kernels that read it.
#pragma once
#include "base/problem.hpp"
#include "scene/key.hpp"
#include "scene/scene.hpp"

namespace clarity {

// All keys but the texture, which is no number. `model` comes first, because it changes others.
const std::vector<Key>& material_keys();
const Key& material_key(const char* name);
// Whether materials of that model have the key.
bool has_key(rt_u32 model, const Key& key);

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
