// map_uses.hpp -- the table of what textures are used for. A new use is a row here, an RT_MAP_ and kernels that read it.
#pragma once
#include <array>

#include "rt_plugin.h"
#include "scene/scene.hpp"

namespace clarity {

struct MapUse {
    const char* name;   // the key of a material in text scenes
    const char* label;  // in the panel
    const char* help;
    rt_u32 space;                           // RT_SPACE_ of textures that say none
    std::array<const char*, 3> multiplies;  // keys of materials, NULL-terminated. Where a file names none, they are 1
};

// By RT_MAP_.
const std::array<MapUse, RT_MAP_USES>& map_uses();
// The number of a use by its name; RT_NONE: there is no such use.
rt_u32 find_map_use(const std::string& name);
const rt_primitive_kind* map_kind_for_plugins();
// Whether a texture lies as its coordinates say.
bool lies_plainly(const rt_map& map);

// Calls tell(use, map) for each map of a material.
template <class Tell>
void each_map(const Scene& scene, const Material& material, const Tell& tell) {
    for (rt_u32 use = 0; use < RT_MAP_USES; ++use)
        if (material.maps[use] != RT_NONE) tell(map_uses()[use], scene.maps[material.maps[use]]);
}

}  // namespace clarity
