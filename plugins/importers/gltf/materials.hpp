// materials.hpp -- the materials of a file as those of the host.
#pragma once
#include <optional>
#include <vector>

#include "accessors.hpp"
#include "maps.hpp"
#include "rt_plugin.h"

namespace gltf_import {

class Materials {
 public:
    Materials(const Document& document, Accessors& accessors, const rt_scene_sink& sink);

    // The material of a primitive, which the sink gets at its first use. RT_NONE: the host's default material.
    rt_u32 id(const Value& primitive);
    // The sets of texture coordinates that the material of a primitive uses.
    TextureSets sets(const Value& primitive) const;

 private:
    rt_u32 add(const Value& material);

    const Value materials_;
    Maps maps_;
    const rt_scene_sink& sink_;
    std::vector<std::optional<rt_u32>> ids_;
};

}  // namespace gltf_import
