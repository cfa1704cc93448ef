// path_scenes.hpp -- the scenes by whose pictures `path` is judged. Their geometry comes from the shared models; what paths
// need besides (surfaces, lamps, the sky) is written here.
#pragma once
#include <string>

#include "support/workbench.hpp"

namespace clarity::test {

// Nothing if a shared model is missing.
ScenePtr cornell_box();         // all Lambert, one lamp in the ceiling
ScenePtr spheres_under_sky();   // metals of five roughnesses, glass, a mirror and a red ball under a picture of a sky
ScenePtr bathroom_under_sky();  // salle_de_bain, Lambert 0.6
ScenePtr showpiece_under_sky();
// The repository's own.
ScenePtr veach_plates();

}  // namespace clarity::test
