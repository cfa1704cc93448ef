// scene_json.hpp -- what is in a scene, as numbers and as JSON: `clarity info` and the library show it.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"

namespace clarity {

// All that `clarity info --json` tells. animations: of clips(), when the scene was at rest.
nlohmann::ordered_json scene_json(const Scene& scene, const std::vector<ClipInfo>& animations,
                                  const std::vector<std::string>& files);

uint64_t face_count(const Scene& scene);
// How many shapes of each kind there are, and how many lights, by the kind's name.
std::map<std::string, uint64_t> shape_counts(const Scene& scene);
std::map<std::string, uint64_t> light_counts(const Scene& scene);
uint64_t materials_with_alpha(const Scene& scene);
std::string sky_text(const Sky& sky);

// Materials as JSON and as text, without values that are defaults.

// Name, model, and all values of the model that are not defaults, by their keys; `texture` if it has one,
// and its maps by their keys.
nlohmann::ordered_json material_json(const Scene& scene, const Material& material);
// The same in a line: "steel: gltf, color 0.5 0.5 0.5, metallic 1".
std::string material_text(const Scene& scene, const Material& material);

}  // namespace clarity
