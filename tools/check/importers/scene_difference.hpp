// scene_difference.hpp -- how a scene that an importer made differs from what it should be.
#pragma once
#include <string>

#include "scene/scene.hpp"
#include "tools/check/importers/samples.hpp"

namespace clarity::check {

// How a scene differs from the truth; empty: it does not.
std::string difference(const Scene& scene, const Contents& truth);

// Where two scenes differ in any bit, "the normal of vertex 7 (mesh 0) is ... and ..."; empty: they do not.
std::string difference(const Scene& a, const Scene& b);

}  // namespace clarity::check
