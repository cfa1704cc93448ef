// material_text.hpp -- materials as JSON and as text, without values that are defaults.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "scene/scene.hpp"

namespace clarity {

// Name, model, and all values of the model that are not defaults, by their keys; `texture` if it has one,
// and its maps by their keys.
nlohmann::ordered_json material_json(const Scene& scene, const Material& material);
// The same in a line: "steel: gltf, color 0.5 0.5 0.5, metallic 1".
std::string material_text(const Scene& scene, const Material& material);

}  // namespace clarity
