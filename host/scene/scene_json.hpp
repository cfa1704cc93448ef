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

}  // namespace clarity
